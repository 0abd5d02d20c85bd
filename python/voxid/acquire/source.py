# SPDX-License-Identifier: BSD-3-Clause
"""What every source of models does, and how a title is matched with words."""
import collections
import re

# Formats that voxid reads (doc/build.md), best first.
FORMATS = ("ply", "obj", "off", "stl", "glb", "gltf", "dae", "3ds", "fbx", "x3d", "lwo", "ac", "ase", "dxf", "blend")

# One model that a source has. `id` is unique in the source and fit for a file name; `size` in bytes, 0 if not known;
# `word` the query that found it; `place` is for the source's own use.
Candidate = collections.namedtuple("Candidate", "source id title format size licence author url word place")


class Source:
    """Somewhere models come from. `name` begins the file names of its models."""

    name = "source"

    def search(self, queries, synsets):
        """Candidates, each once, in an order that does not change. `synsets` are the meaning and its hyponyms."""
        raise NotImplementedError

    def digest(self, candidate):
        """SHA-256 of what `fetch` will write; empty if only that tells."""
        return ""

    def fetch(self, candidate, target, limit_bytes):
        """Writes the model's mesh to `target`; raises Failure if it cannot, or if it is larger than the limit."""
        raise NotImplementedError


def one_line(text):
    """Without what would end the line or move a terminal's cursor; what is no UTF-8 becomes `?`."""
    text = text.encode("utf-8", "replace").decode()
    return " ".join(re.sub(r"[\x00-\x1f\x7f-\x9f]", " ", text).split())


def counted(number, noun):
    """"1 model", "2 models"."""
    return f"{number} {noun}{'' if number == 1 else 's'}"


def printable(candidate):
    """The candidate with texts that fit a report: its source, and whoever names files there, may write anything."""
    fields = ("source", "title", "licence", "author", "url")
    return candidate._replace(**{field: one_line(getattr(candidate, field))[:200] for field in fields})


def plain(text):
    """Lower case words with single spaces: `Coffee-Mug_28` is `coffee mug 28`."""
    return " ".join(re.findall(r"[^\W_]+", re.sub(r"(?<=[a-z])(?=[A-Z])", " ", text).lower()))


def file_name(text):
    """What of a text may stand in a file's name."""
    return re.sub(r"[^a-z0-9]+", "_", text.lower()).strip("_")[:80] or "model"


def singulars(word):
    """The word, and what it may be the plural of."""
    yield word
    if word.endswith("es"):
        yield word[:-2]
    if word.endswith("s"):
        yield word[:-1]


def names(title, word):
    """Whether the title is of a thing called so: the word ends it, or a number, `with`, `of`, `for`, `in` follows."""
    title = re.sub(r"( \d+)+$", "", plain(title))
    title = re.split(r" (?:with|of|for|in|and|on) ", title)[0]
    word = plain(word)
    return bool(word) and any(ending == word or ending.endswith(" " + word) for ending in singulars(title))


def query_for(title, queries):
    """The first query that the title is called by, or None."""
    return next((query for query in queries if names(title, query.word)), None)
