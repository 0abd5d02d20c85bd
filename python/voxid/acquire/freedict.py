# SPDX-License-Identifier: BSD-3-Clause
"""Translations from FreeDict's English dictionaries, as Debian's dict-freedict-eng-* install them."""
import gzip
import pathlib
import re
import struct
import zlib

FOLDER = pathlib.Path("/usr/share/dictd")
DIGITS = {c: i for i, c in enumerate("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/")}


def number_of(text):
    """dictd's numbers: base 64, most significant digit first."""
    number = 0
    for character in text:
        number = number * 64 + DIGITS[character]
    return number


class Dictionary:
    """One language pair: NAME.index, lines of word, offset and length, and NAME.dict.dz, gzip with random access."""

    def __init__(self, index):
        self.language = index.stem.rsplit("-", 1)[1]
        self._index, self._data = index, index.with_suffix(".dict.dz")

    def entries(self, word):
        """The texts of all entries of a word; case does not matter."""
        wanted = word.lower().encode() + b"\t"
        places = []
        with open(self._index, "rb") as lines:
            for line in lines:
                if line[:len(wanted)].lower() == wanted:
                    _, offset, length = line.decode("utf-8", "replace").rstrip("\n").split("\t")[:3]
                    places.append((number_of(offset), number_of(length)))
        return [self._read(*place) for place in sorted(set(places))]

    def _read(self, offset, length):
        with open(self._data, "rb") as file:
            chunks = self._chunks(file)
            if chunks is None:
                with gzip.open(self._data) as whole:
                    whole.seek(offset)
                    return whole.read(length).decode("utf-8", "replace")
            size, sizes, start = chunks
            first, last = offset // size, (offset + length - 1) // size
            file.seek(start + sum(sizes[:first]))
            text = b"".join(zlib.decompressobj(-15).decompress(file.read(n)) for n in sizes[first:last + 1])
        return text[offset - first * size:][:length].decode("utf-8", "replace")

    @staticmethod
    def _chunks(file):
        """(plain size of a chunk, packed sizes, where the first begins); None where the gzip file is ordinary."""
        head = file.read(12)
        if len(head) < 12 or not head[3] & 4:
            return None
        extra = file.read(struct.unpack("<H", head[10:12])[0])
        if extra[:2] != b"RA":
            return None
        size, count = struct.unpack("<HH", extra[6:10])
        for flag in (8, 16):  # original name, comment
            if head[3] & flag:
                while file.read(1) not in (b"\0", b""):
                    pass
        return size, struct.unpack(f"<{count}H", extra[10:10 + 2 * count]), file.tell()


def words_in(entry):
    """The translations of an entry's text: without the head line, marks, notes, synonyms and references."""
    found = []
    for line in entry.splitlines()[1:]:
        line = re.sub(r"^\s*\d+\.\s*", "", line)
        if re.match(r"\s*(Synonyms?|see|Note|Antonyms?|\"|\()", line):
            continue
        line = re.sub(r"<[^>]*>|\[[^\]]*\]|\([^)]*\)|{[^}]*}", "", line)
        found += [word.strip() for word in re.split(r"[,;]", line)]
    return [word for word in dict.fromkeys(found) if re.fullmatch(r"[^\W\d_][\w' -]{1,39}", word)]


def dictionaries(folder=FOLDER):
    return [Dictionary(index) for index in sorted(folder.glob("freedict-eng-*.index"))
            if index.with_suffix(".dict.dz").exists()]
