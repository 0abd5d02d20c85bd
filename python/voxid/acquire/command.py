# SPDX-License-Identifier: BSD-3-Clause
"""voxid acquire WORD: from a word to a category of models in a library."""
import collections
import datetime
import json
import pathlib
import re
import sys
import tempfile

import cv2

from voxid.acquire import judge, meaning, mirrors, source, sweethome3d, words
from voxid.acquire.library import Library, checksum, write_whole
from voxid.acquire.parser import Parser
from voxid.failure import BAD_USE, NOTHING_FOUND, Failure

# A candidate that has been fetched: `key` its place in the library, `mesh` the file, `digest` its SHA-256.
Found = collections.namedtuple("Found", "key candidate mesh digest verdict")


def options_of(arguments):
    parser = Parser(prog="voxid acquire", description="Finds models of what a word means, and keeps them in a library that `voxid build` reads.")
    parser.add_argument("word", metavar="WORD", help="what to learn, in English: mug")
    parser.add_argument("--sense", help="which meaning: WordNet's number (4) or its name (mug.n.04); without it you are asked")
    parser.add_argument("--source", action="append", default=[], metavar="SOURCE",
                        help="sweethome3d, or a folder: of meshes, catalogues (.sh3f), or a mirror of ShapeNet, ModelNet, 3DNet, Objaverse; may be repeated")
    parser.add_argument("--out", type=pathlib.Path, metavar="LIBRARY", help="the library's folder; made if it is not there")
    parser.add_argument("--depth", type=int, default=2, choices=range(0, 9), metavar="0..8", help="levels of narrower words to search for too (2)")
    parser.add_argument("--yes", action="store_true", help="keep all that pass")
    parser.add_argument("--keep", metavar="NUMBERS", help="keep these of the contact sheet, drop the rest: 1,3-5")
    parser.add_argument("--most", type=int, default=200, metavar="N", help="fetch at most so many candidates (200)")
    parser.add_argument("--max-mb", type=int, default=200, metavar="MB", help="leave out files larger than this (200)")
    parser.add_argument("--explain", action="store_true", help="print the words that are searched for, and where each comes from, and end")
    parser.add_argument("--json", action="store_true", help="one JSON object a line: senses, words, or candidates with their verdict")
    options = parser.parse_args(arguments)
    if options.most < 1 or options.max_mb < 1:
        parser.error("--most and --max-mb expect a number of at least 1")
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


def chosen_sense(options, wordnet):
    senses = meaning.senses_of(wordnet, options.word)
    if options.sense is not None:
        return meaning.choose(options.word, senses, options.sense)
    listed = meaning.physical_first(senses)
    for number, synset in listed:
        if options.json:
            print(json.dumps({"sense": number, "name": synset.name(), "synset": meaning.offset_of(synset), "file": synset.lexname(), "gloss": synset.definition()}))
        else:
            print(meaning.line_of(number, synset))
    sys.stdout.flush()
    if not on_terminal():
        raise Failure(f"which {options.word}? Say --sense with one of the numbers above{_advice(options.word, senses)}", BAD_USE)
    return meaning.choose(options.word, senses, ask(f"which {options.word}?"))


def _advice(word, senses):
    """What the reviewed table would take."""
    name, _ = meaning.shipped_table().get(source.file_name(word), ("", 0))
    return next((f"; the shipped table has {number} ({name})" for number, synset in senses if synset.name() == name), "")


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


def opened(name):
    if name == "sweethome3d":
        return sweethome3d.Catalogues()
    if list(pathlib.Path(name).glob("*.sh3f")):
        return sweethome3d.Catalogues(name)
    return mirrors.open_folder(name)


def fetch_and_judge(options, program, where, candidate, key, folder):
    mesh = folder / f"{len(list(folder.iterdir()))}.{candidate.format}"
    try:
        where.fetch(candidate, mesh, options.max_mb << 20)
    except (Failure, OSError) as failure:
        return Found(key, candidate, None, "", judge.Verdict(" ".join(str(failure).split()), 0, None, None))
    return Found(key, candidate, mesh, checksum(mesh), judge.judge(program, mesh))


def candidates_of(sources, queries, synsets, library, category, most):
    """(source, candidate, key) of what is not settled in the library, each key once."""
    settled = {key.rsplit(".", 1)[0] for key, _ in library.models(category)}
    number = 0
    for where in sources:
        for candidate in where.search(queries, synsets):
            key = f"{category}/{where.name}_{candidate.id}"
            if key in settled:
                continue
            settled.add(key)
            number += 1
            if number > most:
                return
            yield where, candidate, f"{key}.{candidate.format}"


def without_duplicates(program, found, library, category):
    """Drops what has the shape or the bytes of an earlier one, or of one that the library has already."""
    known = [(key, judge.judge(program, library.root / key).bins) for key, _ in library.kept(category)]
    known = [(key, bins) for key, bins in known if bins is not None]
    digests = {note.get("sha256"): key for key, note in library.kept(category)}
    result = []
    for one in found:
        if not one.verdict.reason:
            twin = digests.get(one.digest) or judge.duplicate_of(one.verdict.bins, known)
            if twin:
                one = one._replace(verdict=one.verdict._replace(reason=f"the same shape as {twin}"))
            else:
                known.append((one.key, one.verdict.bins))
                digests[one.digest] = one.key
        result.append(one)
    return result, [bins for _, bins in known]


def ranked(found, class_bins):
    """(strangeness, found) of those that pass, the most usual first; then those dropped."""
    passed = [one for one in found if not one.verdict.reason]
    others = class_bins[:len(class_bins) - len(passed)]
    strange = judge.strangeness(others + [one.verdict.bins for one in passed])[len(others):]
    return sorted(zip(strange, passed), key=lambda pair: (pair[0], pair[1].key)), [one for one in found if one.verdict.reason]


def report(options, passed, dropped):
    for number, (strange, one) in enumerate(passed, 1):
        say(options, number, one, {"strangeness": round(strange, 4)})
    for one in dropped:
        say(options, None, one, {"dropped": one.verdict.reason})


def say(options, number, one, more):
    candidate = one.candidate
    if options.json:
        print(json.dumps({"number": number, "model": one.key, "title": candidate.title, "format": candidate.format, "bytes": candidate.size,
                          "licence": candidate.licence, "author": candidate.author, "url": candidate.url,
                          "source": candidate.source, "word": candidate.word.word, "triangles": one.verdict.triangles, **more}, ensure_ascii=False))
    elif number is None:
        print(f"   -  {one.key}  \"{candidate.title}\"  dropped: {one.verdict.reason}")
    else:
        print(f"{number:4}  {one.key}  \"{candidate.title}\"  {candidate.licence or 'licence not stated'}  {candidate.author}  {one.verdict.triangles} triangles")
    sys.stdout.flush()


def choice(options, passed, sheet):
    if options.yes:
        return set(range(1, len(passed) + 1))
    if options.keep is not None:
        return numbers_of(options.keep, len(passed))
    if not on_terminal():
        raise Failure(f"keep which of {len(passed)}? {sheet} shows them; say --keep with their numbers, or --yes", BAD_USE)
    answer = ask(f"keep which of {len(passed)}, shown in {sheet}? (all, none, or such as 1,3-5)")
    return set(range(1, len(passed) + 1)) if answer == "all" else set() if answer in ("", "none") else numbers_of(answer, len(passed))


def note_of(one, verdict):
    candidate = one.candidate
    note = {"title": candidate.title, "source": candidate.source, "url": candidate.url, "licence": candidate.licence, "author": candidate.author,
            "word": candidate.word.word, "sha256": one.digest, "verdict": verdict,
            "date": datetime.datetime.now(datetime.timezone.utc).strftime("%Y-%m-%d")}
    return {field: value for field, value in note.items() if value}


def write_sheet(library, category, passed):
    sheet = library.root / category / "contact_sheet.png"
    sheet.parent.mkdir(parents=True, exist_ok=True)
    pictures = [(f"{number} {one.candidate.title}".encode("ascii", "replace").decode(), one.verdict.thumbnail) for number, (_, one) in enumerate(passed, 1)]
    write_whole(sheet, cv2.imencode(".png", judge.contact_sheet(pictures))[1].tobytes())
    return sheet


def settle(library, category, synset, passed, dropped, numbers):
    for number, (_, one) in enumerate(passed, 1):
        if number in numbers:
            library.keep(one.key, one.mesh)
        library.notes[one.key] = note_of(one, "kept" if number in numbers else "dropped: by hand")
    for one in dropped:
        library.notes[one.key] = note_of(one, f"dropped: {one.verdict.reason}")
    if library.kept(category):
        library.notes[category] = {"synset": meaning.offset_of(synset), "sense": synset.name(), "gloss": synset.definition(),
                                   "coarser": [meaning.offset_of(wider) for wider in meaning.coarser(synset)]}
    library.save()


def clash(library, category, synset):
    known = library.notes.get(category, {}).get("synset", meaning.offset_of(synset))
    if known != meaning.offset_of(synset):
        raise Failure(f"{library.root} has {category} already, as synset {known}, not {meaning.offset_of(synset)} "
                      f"({synset.name()}); one folder holds one meaning: choose another --out", BAD_USE)


def acquire(options, program, synset, queries):
    category = source.file_name(options.word)
    sources = [opened(name) for name in options.source]
    library = Library(options.out)
    with library.locked(), tempfile.TemporaryDirectory(prefix="voxid-acquire-") as folder:
        clash(library, category, synset)
        synsets = [synset, *words.hyponyms(synset, options.depth)]
        found = [fetch_and_judge(options, program, where, candidate, key, pathlib.Path(folder))
                 for where, candidate, key in candidates_of(sources, queries, synsets, library, category, options.most)]
        found, class_bins = without_duplicates(program, found, library, category)
        passed, dropped = ranked(found, class_bins)
        report(options, passed, dropped)
        numbers = choice(options, passed, write_sheet(library, category, passed)) if passed else set()
        settle(library, category, synset, passed, dropped, numbers)
    kept = len(library.kept(category))
    print(f"voxid: {library.root}: {len(numbers)} models of {len(found)} new candidates kept; {category} ({synset.name()}) has {kept}", file=sys.stderr)
    if kept == 0:
        raise Failure(f"no model of {options.word} was kept; --explain shows the words that were searched for", NOTHING_FOUND)
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
