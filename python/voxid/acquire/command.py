# SPDX-License-Identifier: BSD-3-Clause
"""voxid acquire WORD: from a word to a category of models in a library."""
import json
import pathlib
import re
import sys

from voxid.acquire import gather, judge, meaning, mirrors, review, sketchfab, source, sweethome3d, words
from voxid.acquire.library import Library, write_whole
from voxid.acquire.parser import Parser
from voxid.failure import BAD_USE, CANNOT_DO, NOTHING_FOUND, Failure


def options_of(arguments):
    parser = Parser(prog="voxid acquire", description="Finds models of what a word means, and keeps them in a library "
                                                      "that `voxid build` reads.")
    parser.add_argument("word", metavar="WORD", help="what to learn, in English: mug")
    parser.add_argument("--sense",
                        help="which meaning: WordNet's number (4) or its name (mug.n.04); without it you are asked")
    parser.add_argument("--source", action="append", default=[], metavar="SOURCE",
                        help="sweethome3d, sketchfab, or a folder: of meshes, catalogues (.sh3f), or a mirror of "
                             "ShapeNet, ModelNet, 3DNet, Objaverse; may be repeated")
    parser.add_argument("--out", type=pathlib.Path, metavar="LIBRARY",
                        help="the library's folder; made if it is not there")
    parser.add_argument("--depth", type=int, default=2, choices=range(0, 9), metavar="0..8",
                        help="levels of narrower words to search for too (2)")
    parser.add_argument("--yes", action="store_true", help="keep all that pass")
    parser.add_argument("--keep", metavar="NUMBERS", help="keep these of the contact sheet, drop the rest: 1,3-5")
    parser.add_argument("--review", action="store_true",
                        help="show them turning on a page of this machine's own, to keep or drop by click")
    parser.add_argument("--most", type=int, default=200, metavar="N", help="fetch at most so many candidates (200)")
    parser.add_argument("--max-mb", type=int, default=200, metavar="MB",
                        help="leave out files larger than this, packed or unpacked (200)")
    parser.add_argument("--timeout", type=float, default=30, metavar="S",
                        help="give a server up that sends nothing for so long; twenty times that for one file (30)")
    parser.add_argument("--explain", action="store_true",
                        help="print the words that are searched for, and where each comes from, and end")
    parser.add_argument("--json", action="store_true",
                        help="one JSON object a line: senses, words, or candidates with their verdict")
    options = parser.parse_args(arguments)
    options.word = " ".join(options.word.split())
    if options.most < 1 or options.max_mb < 1:
        parser.error("--most and --max-mb expect a number of at least 1")
    if not 0.1 <= options.timeout <= 3600:
        parser.error("--timeout expects 0.1 to 3600 seconds")
    if options.sense is not None:  # else the senses are listed first
        need_places(options)
    return options


def need_places(options):
    if not options.explain and not (options.source and options.out):
        raise Failure("acquire needs --source and --out, or --explain; see voxid acquire --help", BAD_USE)


def numbers_of(text, most):
    """{1, 3, 4, 5} of `1,3-5`."""
    numbers = set()
    for part in filter(None, re.split(r"[,\s]+", text.strip())):
        ends = re.fullmatch(r"(\d{1,6})(?:-(\d{1,6}))?", part)
        first, last = (int(ends[1]), int(ends[2] or ends[1])) if ends else (0, 0)
        if not 1 <= first <= last <= most:
            raise Failure(f"'{part}' is not among the numbers 1 to {most}; expected such as 1,3-5", BAD_USE)
        numbers.update(range(first, last + 1))
    return numbers


def on_terminal():
    return sys.stdin.isatty() and sys.stderr.isatty()


def ask(question):
    print(question, end=" ", file=sys.stderr, flush=True)
    answer = sys.stdin.readline()
    if not answer:
        raise Failure("no answer", BAD_USE)
    return answer.strip()


def list_senses(senses, as_json):
    for number, synset in meaning.physical_first(senses):
        if as_json:
            print(json.dumps({"sense": number, "name": synset.name(), "synset": meaning.offset_of(synset),
                              "file": synset.lexname(), "gloss": synset.definition()}))
        else:
            print(meaning.line_of(number, synset))
    sys.stdout.flush()


def chosen_sense(options, wordnet):
    senses = meaning.senses_of(wordnet, options.word)
    if options.sense is not None:
        return meaning.choose(options.word, senses, options.sense)
    list_senses(senses, options.json)
    if not on_terminal():
        advice = _advice(options.word, senses)
        raise Failure(f"which {options.word}? Say --sense with one of the numbers above{advice}", BAD_USE)
    return meaning.choose(options.word, senses, ask(f"which {options.word}?"))


def _advice(word, senses):
    """What the reviewed table would take."""
    name, _ = meaning.shipped_table().get(source.file_name(word), ("", 0))
    numbers = (number for number, synset in senses if synset.name() == name)
    return next((f"; the shipped table has {number} ({name})" for number in numbers), "")


def explain(options, synset, queries):
    if options.json:
        for query in queries:
            print(json.dumps(query._asdict(), ensure_ascii=False))
        return 0
    print(f"{synset.name()}  {meaning.offset_of(synset)}  {synset.definition()}")
    print("coarser: " + ", ".join(wider.name() for wider in meaning.coarser(synset)))
    for query in queries:
        print(f"{query.word}  {query.origin}  {query.about}")
    return 0


def opened(name, options):
    if name == "sweethome3d":
        return sweethome3d.Catalogues()
    if name == "sketchfab":
        return sketchfab.Sketchfab(options.out / ".parts", options.timeout)
    if list(pathlib.Path(name).glob("*.sh3f")):
        return sweethome3d.Catalogues(name)
    return mirrors.open_folder(name)


def report(options, passed, dropped):
    for number, (strange, one) in enumerate(passed, 1):
        say(options, number, one, {"strangeness": round(strange, 4)})
    for one in dropped:
        say(options, None, one, {"dropped": one.verdict.reason, "settled": one.settled})


def say(options, number, one, more):
    candidate = one.candidate
    if options.json:
        line = {"number": number, "model": one.key, "title": candidate.title, "format": candidate.format,
                "bytes": candidate.size, "licence": candidate.licence, "author": candidate.author, "url": candidate.url,
                "source": candidate.source, "word": candidate.word.word, "triangles": one.verdict.triangles, **more}
        print(json.dumps(line, ensure_ascii=False))
    elif number is None:
        print(f"   -  {one.key}  \"{candidate.title}\"  dropped: {one.verdict.reason}")
    else:
        print(f"{number:4}  {one.key}  \"{candidate.title}\"  {candidate.licence or 'licence not stated'}  "
              f"{candidate.author}  {one.verdict.triangles} triangles")
    sys.stdout.flush()


def choice(options, program, passed, sheet):
    if options.review:
        waiting = source.counted(len(passed), "candidate")
        announce = lambda address: gather.say(f"{waiting} to be kept or dropped at {address}")
        return review.Review(program, options.word, passed).ask(announce)
    if options.yes:
        return set(range(1, len(passed) + 1))
    if options.keep is not None:
        return numbers_of(options.keep, len(passed))
    if not on_terminal():
        raise Failure(f"keep which of {len(passed)}? {sheet} shows them; say --keep with their numbers, or --yes",
                      BAD_USE)
    answer = ask(f"keep which of {len(passed)}, shown in {sheet}? (all, none, or such as 1,3-5)")
    if answer == "all":
        return set(range(1, len(passed) + 1))
    return set() if answer in ("", "none") else numbers_of(answer, len(passed))


def caption_of(number, one):
    return f"{number} {one.candidate.title}".encode("ascii", "replace").decode()


def write_sheet(library, category, passed):
    sheet = library.root / category / "contact_sheet.png"
    sheet.parent.mkdir(parents=True, exist_ok=True)
    pictures = [(caption_of(number, one), one.verdict.thumbnail) for number, (_, one) in enumerate(passed, 1)]
    write_whole(sheet, judge.opencv().imencode(".png", judge.contact_sheet(pictures))[1].tobytes())
    return sheet


def settle(library, category, synset, passed, dropped, numbers):
    for number, (_, one) in enumerate(passed, 1):
        if number in numbers:
            library.keep(one.key, one.mesh)
        library.notes[one.key] = gather.note_of(one, "kept" if number in numbers else "dropped: by hand")
    for one in dropped:
        if one.settled:
            library.notes[one.key] = gather.note_of(one, f"dropped: {one.verdict.reason}")
    if library.kept(category):
        library.notes[category] = {"synset": meaning.offset_of(synset), "sense": synset.name(),
                                   "gloss": synset.definition(),
                                   "coarser": [wider.name() for wider in meaning.coarser(synset)]}
    library.save()


def clash(library, category, synset):
    """One category holds one meaning, and no meaning has two: two names of one thing would share its votes."""
    offset, synsets = meaning.offset_of(synset), library.synsets()
    known = synsets.get(category, offset)
    if known != offset:
        raise Failure(f"{library.root} has {category} already, as synset {known}, not {offset} "
                      f"({synset.name()}); one folder holds one meaning: choose another --out", BAD_USE)
    twin = next((name for name, other in synsets.items() if other == offset and name != category), None)
    if twin:
        raise Failure(f"{library.root} has {synset.name()} already, as {twin}, not {category}; "
                      f"`voxid acquire {twin}` adds to it", BAD_USE)


def judge_and_keep(options, program, gatherer, library, synset, queries):
    """How many of how many were kept."""
    category = source.file_name(options.word)
    synsets = [synset, *words.hyponyms(synset, options.depth)]
    sources = [opened(name, options) for name in options.source]
    found = gatherer.gather(sources, queries, synsets, options.most)
    found, old, described = gatherer.without_duplicates(found)
    passed, dropped = gather.ranked(found, old)
    report(options, passed, dropped)
    numbers = choice(options, program, passed, write_sheet(library, category, passed)) if passed else set()
    settle(library, category, synset, passed, dropped, numbers)
    library.save_described(category, described)
    return len(numbers), len(found)


def acquire(options, program, synset, queries):
    category = source.file_name(options.word)
    library = Library(options.out)
    with library.locked(), library.work_folder() as folder:
        clash(library, category, synset)
        gatherer = gather.Gatherer(library, category, folder, options.max_mb << 20)
        taken, found = judge_and_keep(options, program, gatherer, library, synset, queries)
    if gatherer.broken and found == 0:
        return CANNOT_DO  # each source has said why
    kept, candidates = len(library.kept(category)), source.counted(found, "new candidate")
    if kept == 0:
        raise Failure(f"no model of {options.word} was kept, of {candidates}; --explain shows the words that were "
                      "searched for", NOTHING_FOUND)
    gather.say(f"{library.root}: {taken} of {candidates} kept; "
               f"{category} ({synset.name()}) has {source.counted(kept, 'model')}")
    return 0


def run(program, arguments):
    options = options_of(arguments)
    with meaning.WordNet() as wordnet:
        synset = chosen_sense(options, wordnet)
        need_places(options)
        queries = words.queries(synset, options.depth)
        if options.explain:
            return explain(options, synset, queries)
        return acquire(options, program, synset, queries)
