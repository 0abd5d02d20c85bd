# SPDX-License-Identifier: BSD-3-Clause
"""glTF 2.0 (https://registry.khronos.org/glTF/specs/2.0) as one file with its buffers inside, as a library wants it."""
import base64
import itertools
import json
import posixpath
import struct
import urllib.parse

from voxid.failure import DAMAGED, Failure

FORMATS = ("gltf", "glb")


def whole(files, name):
    """The bytes of a .gltf or .glb with what its buffers name; without pictures and materials if anything was taken in.
    `files.read(name)` gives the bytes of a file."""
    make = _whole_glb if name.lower().endswith(".glb") else _whole_gltf
    try:
        return make(files, name)
    except (ValueError, RecursionError, AttributeError, TypeError, LookupError, struct.error):
        raise Failure(f"'{name[:60]}' is no glTF", DAMAGED) from None


def _whole_gltf(files, name):
    scene = json.loads(files.read(name))
    for buffer in scene.get("buffers", []):
        if not _uri_of(buffer).startswith("data:"):
            text = base64.b64encode(_read(files, name, _uri_of(buffer))).decode()
            buffer["uri"] = f"data:application/octet-stream;base64,{text}"
    _leave_pictures(scene)
    return json.dumps(scene).encode()


def _whole_glb(files, name):
    """Assimp looks for the first buffer in the file itself and nowhere else: all become that one."""
    data = files.read(name)
    if not data.startswith(b"glTF\x02\0\0\0"):
        return data  # of version 1, or none: its reader says so
    chunks = dict(_chunks(data))
    scene = json.loads(chunks[b"JSON"])
    buffers = scene.get("buffers", [])
    if not any(map(_uri_of, buffers)):
        return data
    joined = [_padded(_buffer(files, name, _uri_of(buffer), chunks), b"\0") for buffer in buffers]
    starts = list(itertools.accumulate(map(len, joined), initial=0))
    for view in scene.get("bufferViews", []):
        view["byteOffset"] = view.get("byteOffset", 0) + starts[view["buffer"]]
        view["buffer"] = 0
    scene["buffers"] = [{"byteLength": starts[-1]}]
    _leave_pictures(scene)
    return _glb(scene, b"".join(joined))


def _uri_of(buffer):
    return buffer.get("uri", "")


def _read(files, name, uri):
    """A file that is named beside `name`."""
    return files.read(posixpath.normpath(posixpath.join(posixpath.dirname(name), urllib.parse.unquote(uri))))


def _buffer(files, name, uri, chunks):
    if not uri:
        return chunks[b"BIN\0"]
    return base64.b64decode(uri.partition(",")[2]) if uri.startswith("data:") else _read(files, name, uri)


def _chunks(data):
    """(kind, bytes) of each chunk of a GLB."""
    at = 12
    while at < len(data):
        length, kind = struct.unpack_from("<I4s", data, at)
        yield kind, data[at + 8:at + 8 + length]
        at += 8 + length


def _padded(data, filler):
    return data + filler * (-len(data) % 4)


def _glb(scene, buffer):
    text = _padded(json.dumps(scene).encode(), b" ")
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(buffer), b"BIN\0") + buffer
    return b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks


def _leave_pictures(scene):
    for field in ("images", "textures", "samplers", "materials", "extensionsUsed", "extensionsRequired", "animations"):
        scene.pop(field, None)
    for mesh in scene.get("meshes", []):
        for primitive in mesh.get("primitives", []):
            primitive.pop("material", None)
