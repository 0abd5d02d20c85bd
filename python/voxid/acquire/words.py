# SPDX-License-Identifier: BSD-3-Clause
"""Which words are searched for: lemmas, hyponyms, translations."""
import collections
import pathlib

import yaml

from voxid.acquire import freedict

# Reviewed translations of common categories; where they name a language, its dictionary is not asked.
REVIEWED = pathlib.Path(__file__).resolve().parents[3] / "cfg" / "translations.yaml"

# `origin` is lemma, hyponym or translation; `about` the synset, or language and the English word that was translated.
Query = collections.namedtuple("Query", "word origin about")


def plain(lemma):
    return lemma.replace("_", " ")


def hyponyms(synset, depth):
    """Narrower synsets, nearest level first, each once."""
    seen, level, found = {synset}, [synset], []
    for _ in range(depth):
        level = [narrower for wide in level for narrower in wide.hyponyms() if narrower not in seen]
        level = list(dict.fromkeys(level))
        seen.update(level)
        found += level
    return found


def translations(synset, dictionaries, reviewed):
    """(word, language, translated word): the reviewed ones, else those of the first lemma that a dictionary has."""
    table = reviewed.get(synset.name(), {})
    for language in sorted(set(table) | {d.language for d in dictionaries}):
        if language in table:
            yield from ((word, language, "reviewed") for word in table[language])
            continue
        dictionary = next(d for d in dictionaries if d.language == language)
        for lemma in map(plain, synset.lemma_names()):
            # The first entry alone: later ones are other senses more often than not.
            found = [word for entry in dictionary.entries(lemma)[:1] for word in freedict.words_in(entry)[:2]]
            if found:
                yield from ((word, language, lemma) for word in found)
                break


def reviewed_table(path=REVIEWED):
    return yaml.safe_load(path.read_text()) if path.exists() else {}


def queries(synset, depth=2, dictionaries=None, reviewed=None):
    """Every word once, in the order in which it is searched for."""
    dictionaries = freedict.dictionaries() if dictionaries is None else dictionaries
    reviewed = reviewed_table() if reviewed is None else reviewed
    found = [Query(plain(lemma), "lemma", synset.name()) for lemma in synset.lemma_names()]
    for narrower in hyponyms(synset, depth):
        found += [Query(plain(lemma), "hyponym", narrower.name()) for lemma in narrower.lemma_names()]
    found += [Query(word, "translation", f"{language}, {source}")
              for word, language, source in translations(synset, dictionaries, reviewed)]
    once = {}
    for query in found:
        once.setdefault(query.word.lower(), query)
    return list(once.values())
