# SPDX-License-Identifier: BSD-3-Clause
"""A library on disk: <library>/<category>/<model>.<ext>, and library.json, which `voxid build` reads (doc/build.md)."""
import contextlib
import fcntl
import hashlib
import json
import os
import pathlib
import shutil

import numpy as np

from voxid.acquire.judge import Shape
from voxid.failure import CANNOT_DO, DAMAGED, Failure


CODE_NUMBERS = 96  # of the shipped projection
DESCRIBED = f".described{CODE_NUMBERS}.json"  # what another projection described is made anew


def checksum(path):
    """SHA-256 of a file, in hexadecimal."""
    digest = hashlib.sha256()
    with open(path, "rb") as file:
        while block := file.read(1 << 20):
            digest.update(block)
    return digest.hexdigest()


def write_whole(path, data):
    """Writes beside, fsyncs, renames: a reader sees the old file or the new one."""
    beside = path.with_name(f".{path.name}.part")
    try:
        with open(beside, "wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        os.replace(beside, path)
    except OSError as error:
        beside.unlink(missing_ok=True)
        raise OSError(error.errno, error.strerror, str(path)) from None
    folder = os.open(path.parent, os.O_RDONLY)
    try:
        os.fsync(folder)
    finally:
        os.close(folder)


def _shape(bins, views):
    bins = np.frombuffer(bytes.fromhex(bins), np.uint8).astype(np.int32)
    return Shape(bins, np.frombuffer(bytes.fromhex(views), np.int8).reshape(-1, CODE_NUMBERS))


class Library:
    """What library.json says; `notes` is category -> note and category/file -> note."""

    def __init__(self, root):
        self.root = pathlib.Path(root)
        self._file = self.root / "library.json"
        self.notes = self._read()

    def _read(self):
        if not self._file.exists():
            return {}
        try:
            notes = json.loads(self._file.read_text())
        except ValueError as error:
            raise Failure(f"{self._file} is no JSON: {error}", DAMAGED) from None
        if not isinstance(notes, dict) or not all(isinstance(note, dict) for note in notes.values()):
            raise Failure(f"{self._file} is not a JSON object of notes; see doc/build.md", DAMAGED)
        return notes

    @contextlib.contextmanager
    def locked(self):
        """One writer at a time; what another wrote meanwhile is read anew."""
        self.root.mkdir(parents=True, exist_ok=True)
        with open(self.root / ".lock", "w") as lock:
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                raise Failure(f"{self.root} is being written by another voxid; wait for it to end", CANNOT_DO) from None
            self.notes = self._read()
            yield

    @contextlib.contextmanager
    def work_folder(self):
        """For what is on its way, while the library is locked; what a killed run left there is removed."""
        folder = self.root / ".work"
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir()
        try:
            yield folder
        finally:
            shutil.rmtree(folder, ignore_errors=True)

    def models(self, category=None):
        """(category/file, note) of the models, kept and dropped, in order."""
        return [(key, note) for key, note in sorted(self.notes.items())
                if "/" in key and category in (None, key.split("/")[0])]

    def synsets(self):
        """Category -> the offset of its synset in eight digits, of those that have one (doc/build.md)."""
        return {key: str(note["synset"]).removeprefix("n").zfill(8) for key, note in sorted(self.notes.items())
                if "/" not in key and "synset" in note}

    def kept(self, category=None):
        return [(key, note) for key, note in self.models(category) if (self.root / key).is_file()]

    def keep(self, key, mesh):
        target = self.root / key
        target.parent.mkdir(parents=True, exist_ok=True)
        write_whole(target, mesh.read_bytes())

    def described(self, category):
        """SHA-256 -> the shape of models of a category that were described before, so that no run does it again."""
        try:
            texts = json.loads((self.root / category / DESCRIBED).read_text())
            return {digest: _shape(*pair) for digest, pair in texts.items()}
        except (OSError, ValueError, AttributeError, TypeError):
            return {}  # made anew

    def save_described(self, category, shapes):
        """Of what the library keeps; the rest is forgotten."""
        kept = {note.get("sha256") for _, note in self.kept(category)}
        texts = {digest: [shapes[digest].bins.astype(np.uint8).tobytes().hex(), shapes[digest].views.tobytes().hex()]
                 for digest in sorted(kept & set(shapes)) if shapes[digest] is not None}
        target = self.root / category / DESCRIBED
        text = json.dumps(texts, indent=0).encode()
        if texts and not (target.exists() and target.read_bytes() == text):
            write_whole(target, text)

    def save(self):
        text = json.dumps(self.notes, indent=1, sort_keys=True, ensure_ascii=False) + "\n"
        if not self._file.exists() or self._file.read_text() != text:
            write_whole(self._file, text.encode())
