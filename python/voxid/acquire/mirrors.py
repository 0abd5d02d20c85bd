# SPDX-License-Identifier: BSD-3-Clause
"""Folders on disk: any folder of meshes, and local mirrors of ShapeNet, ModelNet, 3DNet, Objaverse by their layout."""
import gzip
import hashlib
import json
import os
import pathlib
import shutil
import zlib

from voxid.acquire import gltf, source
from voxid.acquire.archive import format_in, unpack_mesh
from voxid.acquire.library import checksum
from voxid.failure import DAMAGED, Failure

# Which of several files of one model is taken.
PREFERRED = {format_: rank for rank, format_ in enumerate(source.FORMATS)}


def files_under(folder, formats):
    """In the order of their paths; links to folders are not followed, so that the walk ends."""
    return sorted(path for path in folder.rglob("*") if path.suffix[1:].lower() in formats and path.is_file())


def format_of(path):
    """By the name; of an archive, that of the mesh in it. `zip` if it has none: fetching it says why."""
    try:
        return format_in(path) if path.suffix.lower() == ".zip" else path.suffix[1:].lower()
    except Failure:
        return "zip"


class Inside:
    """Files of a folder, and no others; `limit_bytes` is for all that is read together."""

    def __init__(self, root, limit_bytes):
        self._root, self._left, self._limit = root.resolve(), limit_bytes, limit_bytes

    def read(self, name):
        path = (self._root / name).resolve()
        if self._root not in path.parents:
            raise Failure(f"it names '{name[:60]}', outside the source's folder", DAMAGED)
        if not path.is_file():
            raise Failure(f"it names '{name[:60]}', which is not there", DAMAGED)
        self._left -= path.stat().st_size
        if self._left < 0:
            raise Failure(f"it and what it names have more than {self._limit} bytes")
        return path.read_bytes()


def read_json(path):
    try:
        opened = gzip.open(path, "rt") if path.suffix == ".gz" else open(path)
        with opened as file:
            return json.load(file)
    except (ValueError, EOFError, RecursionError, zlib.error, gzip.BadGzipFile) as error:
        raise Failure(f"{path} is no JSON: {error}", DAMAGED) from None


def read_object(path):
    value = read_json(path)
    if not isinstance(value, dict):
        raise Failure(f"{path} is no JSON object", DAMAGED)
    return value


class OnDisk(source.Source):
    """What the mirrors share: a candidate's place is a path."""

    licence = author = url = ""

    def __init__(self, root):
        self._root = root

    def candidate(self, path, id_, title, query, **known):
        fields = {"licence": self.licence, "author": self.author, "url": self.url, **known}
        return source.Candidate(f"{self.name}: {path.relative_to(self._root)}", source.file_name(id_), title,
                                format_of(path), path.stat().st_size, word=query, place=path, **fields)

    def fetch(self, candidate, target, limit_bytes):
        path = candidate.place
        if path.stat().st_size > limit_bytes:
            raise Failure(f"{path} has more than {limit_bytes} bytes")
        if path.suffix.lower() == ".zip":
            target.write_bytes(unpack_mesh(path, limit_bytes)[1])
        elif candidate.format in gltf.FORMATS:
            name = path.relative_to(self._root).as_posix()
            target.write_bytes(gltf.whole(Inside(self._root, limit_bytes), name))
        else:
            shutil.copyfile(path, target)


def id_of(stem, taken):
    """What names the model of a file: its path without ending. Of two that differ only in what a file's name leaves
    out or cuts off, the later gets a sum too; the same model in another format has the same id. `taken`: id -> stem."""
    id_ = source.file_name(stem)
    if taken.setdefault(id_, stem) == stem:
        return id_
    return f"{id_[:71]}_{hashlib.sha256(os.fsencode(stem)).hexdigest()[:8]}"


class Folder(OnDisk):
    """Any folder: a mesh, or a zip archive with one, is called by its own name, or by that of a folder that it lies in,
    the given one included (ModelNet, 3DNet)."""

    name = "folder"

    def search(self, queries, synsets):
        taken = {}
        for path in files_under(self._root, {*PREFERRED, "zip"}):
            inner = path.relative_to(self._root)
            titles = [path.stem, *reversed(inner.parent.parts), os.path.basename(os.path.abspath(self._root))]
            query = next(filter(None, (source.query_for(title, queries) for title in titles)), None)
            if query is not None:
                yield self.candidate(path, id_of(str(inner.with_suffix("")), taken), path.stem, query)

    def digest(self, candidate):
        if candidate.place.suffix.lower() == ".zip" or candidate.format in gltf.FORMATS:
            return ""
        try:
            return checksum(candidate.place)
        except OSError:
            return ""


class ShapeNet(OnDisk):
    """<synset offset>/<model>/models/model_normalized.obj, or <synset offset>/<model>/model.obj; taxonomy.json
    beside them."""

    name = "shapenet"
    url = "https://shapenet.org"
    licence = "ShapeNet terms of use"

    def search(self, queries, synsets):
        wanted = self._offsets({f"{synset.offset():08d}": synset.name() for synset in synsets})
        for offset, name in sorted(wanted.items()):
            query = source.query_for(name.split(".")[0], queries) or queries[0]
            for model in sorted(path for path in (self._root / offset).glob("*") if path.is_dir()):
                files = files_under(model, PREFERRED)
                if files:
                    yield self.candidate(files[0], f"{offset}_{model.name}", f"{name} {model.name}", query)

    def _offsets(self, wanted):
        """Also what the taxonomy files below a wanted synset: its own names, by its own tree."""
        taxonomy = read_json(self._root / "taxonomy.json")
        try:
            if not isinstance(taxonomy, list):
                raise TypeError
            children = {node["synsetId"]: [str(child) for child in node.get("children", [])] for node in taxonomy}
            names = {node["synsetId"]: node.get("name", "").split(",")[0] for node in taxonomy}
        except (TypeError, KeyError, AttributeError):
            raise Failure(f"{self._root}/taxonomy.json is not a list of nodes with synsetId", DAMAGED) from None
        found, waiting = {}, list(wanted)
        while waiting:
            offset = waiting.pop()
            if offset not in found:
                found[offset] = wanted.get(offset, names.get(offset, ""))
                waiting += children.get(offset, [])
        return {offset: name for offset, name in found.items() if offset.isdigit()}


class Objaverse(OnDisk):
    """object-paths.json[.gz] (uid -> glbs/000-000/uid.glb) and metadata/*.json[.gz] (uid -> name, license, user,
    viewerUrl)."""

    name = "objaverse"

    def search(self, queries, synsets):
        paths = read_object(next(p for p in (self._root / "object-paths.json", self._root / "object-paths.json.gz")
                                 if p.exists()))
        root = self._root.resolve()
        for file in sorted((self._root / "metadata").glob("*.json*")):
            for uid, about in sorted(read_object(file).items()):
                if not isinstance(about, dict) or not isinstance(about.get("name"), str):
                    continue
                query = source.query_for(about["name"], queries)
                path = self._root / str(paths.get(uid, ""))
                if query is not None and root in path.resolve().parents and path.is_file():
                    yield self.candidate(path, uid, about["name"], query, **self._origin(about))

    @staticmethod
    def _origin(about):
        user = about["user"] if isinstance(about.get("user"), dict) else {}
        texts = {"licence": about.get("license"), "author": user.get("displayName") or user.get("username"),
                 "url": about.get("viewerUrl")}
        return {field: text if isinstance(text, str) else "" for field, text in texts.items()}


def open_folder(root):
    """The source that a folder's layout is of."""
    root = pathlib.Path(root)
    if not root.is_dir():
        raise Failure(f"{root} is no folder")
    if (root / "taxonomy.json").exists():
        return ShapeNet(root)
    if (root / "object-paths.json").exists() or (root / "object-paths.json.gz").exists():
        return Objaverse(root)
    return Folder(root)
