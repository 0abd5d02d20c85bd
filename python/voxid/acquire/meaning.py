# SPDX-License-Identifier: BSD-3-Clause
"""What a word means: the senses of WordNet 3.0, under WordNet's own numbers."""
import os
import pathlib
import re
import tempfile
import warnings

import yaml

from voxid.failure import BAD_USE, CANNOT_DO, NOTHING_FOUND, Failure

DATABASE = pathlib.Path("/usr/share/wordnet")
SHIPPED = pathlib.Path(__file__).resolve().parents[3] / "cfg" / "synsets.yaml"
# Debian's package lacks the file that numbers the lexicographer files; the order is that of the manual page
# lexnames(5WN).
LEXICOGRAPHER_FILES = (
    "adj.all adj.pert adv.all noun.Tops noun.act noun.animal noun.artifact noun.attribute noun.body noun.cognition "
    "noun.communication noun.event noun.feeling noun.food noun.group noun.location noun.motive noun.object noun.person "
    "noun.phenomenon noun.plant noun.possession noun.process noun.quantity noun.relation noun.shape noun.state "
    "noun.substance "
    "noun.time verb.body verb.change verb.cognition verb.communication verb.competition verb.consumption verb.contact "
    "verb.creation verb.emotion verb.motion verb.perception verb.possession verb.social verb.stative verb.weather "
    "adj.ppl").split()
PARTS_OF_SPEECH = {"noun": 1, "verb": 2, "adj": 3, "adv": 4}
# A camera sees these; their senses are listed first.
PHYSICAL = ("noun.artifact", "noun.food", "noun.animal", "noun.plant", "noun.object", "noun.body", "noun.substance")


class WordNet:
    """The database's nouns, open while the block lasts."""

    def __enter__(self):
        if not (DATABASE / "data.noun").exists():
            raise Failure(f"{DATABASE}/data.noun is not there; scripts/install_deps installs wordnet-base", CANNOT_DO)
        try:
            from nltk.corpus.reader.wordnet import WordNetCorpusReader
        except ImportError:
            raise Failure("NLTK is not installed; scripts/install_deps installs python3-nltk", CANNOT_DO) from None
        self._folder = tempfile.TemporaryDirectory(prefix="voxid-wordnet-")
        root = pathlib.Path(self._folder.name)
        for name in os.listdir(DATABASE):
            (root / name).symlink_to(DATABASE / name)
        for name in ("index.verb", "index.adj", "index.adv"):  # NLTK would read every line of them
            (root / name).unlink(missing_ok=True)
            (root / name).touch()
        (root / "lexnames").unlink(missing_ok=True)
        (root / "lexnames").write_text("".join(
            f"{number:02d}\t{name}\t{PARTS_OF_SPEECH[name.split('.')[0]]}\n"
            for number, name in enumerate(LEXICOGRAPHER_FILES)))
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # about languages that are not asked for
            self.reader = WordNetCorpusReader(str(root), None)
        return self

    def __exit__(self, *_):
        self._folder.cleanup()

    def senses(self, word):
        """(number, synset) of each meaning as a noun, in WordNet's order; numbers begin with 1."""
        return list(enumerate(self.reader.synsets(word.replace(" ", "_"), "n"), 1))

    def synset(self, name):
        return self.reader.synset(name)

    def of_offset(self, offset):
        return self.reader.synset_from_pos_and_offset("n", offset)


def physical_first(senses):
    return sorted(senses, key=lambda sense: sense[1].lexname() not in PHYSICAL)


def line_of(number, synset):
    """`4  mug.n.04  noun.artifact  with handle and usually cylindrical`."""
    return f"{number}  {synset.name()}  {synset.lexname()}  {synset.definition()}"


def choose(word, senses, wanted):
    """The synset that `wanted` names, a number or an NLTK name."""
    for number, synset in senses:
        if wanted in (str(number), synset.name()):
            return synset
    raise Failure(f"--sense {wanted}: {word} has no such sense; it has "
                  + ", ".join(f"{number} ({synset.name()})" for number, synset in senses), BAD_USE)


def is_word(word):
    """What WordNet's words are made of, and what may also name a folder."""
    return re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9 _'-]{0,63}", word) is not None


def senses_of(wordnet, word):
    if not is_word(word):
        raise Failure(f"'{word}' is no word: expected letters a to z, digits, spaces, hyphens, at most 64", BAD_USE)
    senses = wordnet.senses(word)
    if not senses:
        raise Failure(f"WordNet does not know the noun '{word}'; try a more common or a more general word",
                      NOTHING_FOUND)
    return senses


def offset_of(synset):
    """As library.json and the index write it: eight digits, ShapeNet's synsetId."""
    return f"{synset.offset():08d}"


def coarser(synset):
    """Hypernyms, the nearest first, up to the root, along the first path."""
    path = []
    while synset.hypernyms() or synset.instance_hypernyms():
        synset = (synset.hypernyms() + synset.instance_hypernyms())[0]
        path.append(synset)
    return path


def shipped_table(path=SHIPPED):
    """Category -> (NLTK name, offset), reviewed by hand."""
    try:
        return {category: tuple(entry) for category, entry in yaml.safe_load(path.read_text())["categories"].items()}
    except FileNotFoundError:
        raise Failure(f"{path} is not there; it belongs to voxid", CANNOT_DO) from None
