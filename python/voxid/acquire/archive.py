# SPDX-License-Identifier: BSD-3-Clause
"""The mesh of a zip archive that somebody else made: nothing is written under a name of the archive's own, and
what unpacks to more than the limit is refused, whatever its headers say."""
import pathlib
import re
import zipfile
import zlib

from voxid.acquire import gltf, source
from voxid.failure import DAMAGED, Failure

MOST_DIRECTORY_BYTES = 4 << 20  # some ten thousand names
PREFERRED = {format_: rank for rank, format_ in enumerate(("glb", "gltf", *source.FORMATS))}


def _check_directory(path):
    """Before zipfile reads the directory into memory: how much of it there is."""
    with open(path, "rb") as file:
        file.seek(max(0, path.stat().st_size - 65557))
        tail = file.read()
    end = tail.rfind(b"PK\x05\x06")
    if end < 0 or len(tail) - end < 22:
        raise Failure("no zip archive", DAMAGED)
    is_zip64 = tail[max(0, end - 20):end].startswith(b"PK\x06\x07")  # of more than 4 GB, or 65,535 names
    if is_zip64 or int.from_bytes(tail[end + 12:end + 16], "little") > MOST_DIRECTORY_BYTES:
        raise Failure(f"the archive's directory has more than {MOST_DIRECTORY_BYTES} bytes")


def _leaves(name):
    """Whether a name leads out of the folder that an archive is unpacked in."""
    name = name.replace("\\", "/")
    return name.startswith("/") or re.match(r"[A-Za-z]:", name) is not None or ".." in name.split("/")


class Archive:
    """Of `path`; `limit_bytes` is for all that is read from it together."""

    def __init__(self, path, limit_bytes):
        self._path, self._left, self._limit = pathlib.Path(path), limit_bytes, limit_bytes

    def __enter__(self):
        _check_directory(self._path)
        try:
            self._zip = zipfile.ZipFile(self._path)
        except (zipfile.BadZipFile, ValueError, NotImplementedError) as error:
            raise Failure(f"no sound zip archive: {error}", DAMAGED) from None
        outside = next(filter(_leaves, self._zip.namelist()), None)
        if outside is not None:
            self._zip.close()
            raise Failure(f"the archive names '{outside[:60]}', outside its own folder", DAMAGED)
        return self

    def __exit__(self, *_):
        self._zip.close()

    def names(self):
        return sorted(self._zip.namelist())

    def read(self, name):
        """The bytes of a member; counted as they come, for a header may lie."""
        try:
            with self._zip.open(name) as file:
                data = file.read(self._left + 1)
        except KeyError:
            raise Failure(f"the archive has no '{name[:60]}'", DAMAGED) from None
        except (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, RuntimeError) as error:
            raise Failure(f"'{name[:60]}' in the archive is damaged: {error}", DAMAGED) from None
        self._left -= len(data)
        if self._left < 0:
            raise Failure(f"the archive unpacks to more than the limit of {self._limit} bytes")
        return data


def mesh_in(names):
    """The member that is the model: of the best format, nearest the top, first by name."""
    ranked = [(PREFERRED[name.rsplit(".", 1)[-1].lower()], name.count("/"), name) for name in names
              if name.rsplit(".", 1)[-1].lower() in PREFERRED and not name.startswith("__MACOSX/")]
    if not ranked:
        raise Failure("the archive holds no mesh of a format that voxid reads")
    return min(ranked)[2]


def format_in(path):
    """Of the archive's mesh."""
    with Archive(path, 0) as archive:
        return mesh_in(archive.names()).rsplit(".", 1)[-1].lower()


def unpack_mesh(path, limit_bytes):
    """(format, bytes) of the archive's mesh."""
    with Archive(path, limit_bytes) as archive:
        name = mesh_in(archive.names())
        format_ = name.rsplit(".", 1)[-1].lower()
        return format_, gltf.whole(archive, name) if format_ in gltf.FORMATS else archive.read(name)
