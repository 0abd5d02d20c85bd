# SPDX-License-Identifier: BSD-3-Clause
"""voxid acquire from a folder as people keep them: archives, glTF in several files, any name a disk allows."""
import base64
import json
import os

import pytest

import solids
from model_server import glb, glb_of, gltf_zip, packed, scene_of

TIN = solids.turned([(0.0, 0.0), (0.4, 0.0), (0.4, 1.0), (0.0, 1.0)])
CONE = solids.turned([(0.0, 0.0), (0.5, 0.0), (0.0, 1.2)])


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "in").mkdir()
    return tmp_path / "in"


@pytest.fixture
def acquire(voxid, folder, tmp_path):
    """The answer's lines by title, with all that passes kept in tmp_path / "lib"."""

    def run(*more):
        answer = voxid("acquire", "mug", "--sense", 4, "--depth", 0, "--source", folder, "--out", tmp_path / "lib",
                       "--yes", "--json", *more)
        assert answer.code == 0 and len(answer.err.splitlines()) == 1, answer.err
        return {line["title"]: line for line in answer.lines}

    return run


def write_gltf(path, mesh, buffer_at):
    """A .gltf beside its buffer and a picture."""
    scene, buffer = scene_of(mesh)
    scene["buffers"][0]["uri"] = buffer_at
    scene["images"] = [{"uri": "wood.png"}]
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(scene))
    return buffer


def test_gltf_takes_its_buffers_into_the_library_and_builds_there(voxid, acquire, folder, tmp_path):
    buffer = write_gltf(folder / "scenes" / "mug.gltf", TIN, "../buffers/a%20b.bin")
    (folder / "buffers").mkdir()
    (folder / "buffers" / "a b.bin").write_bytes(buffer)
    solids.write_ply(folder / "mug in a heap.ply", CONE)
    acquire()
    kept = tmp_path / "lib/mug/folder_scenes_mug.gltf"
    uri = json.loads(kept.read_text())["buffers"][0]["uri"]
    assert base64.b64decode(uri.split(",")[1]) == buffer
    (folder / "buffers" / "a b.bin").unlink()
    answer = voxid("build", "--models", tmp_path / "lib", "--out", tmp_path / "a.vxi", "--views-every", 16, "--json")
    assert answer.lines[-1]["models"] == 2 and answer.lines[-1]["skipped"] == [], answer.err


def test_files_of_one_name_in_two_folders_are_two_models(voxid, acquire, folder, tmp_path):
    solids.write_ply(folder / "mug" / "0001.ply", TIN)
    other = tmp_path / "other"
    solids.write_ply(other / "mug" / "0001.ply", CONE)
    (folder / "mug" / "0001.stl").write_text("the same model in another format is not looked at")
    acquire("--source", other)
    kept = sorted(path.name for path in (tmp_path / "lib/mug").glob("*.ply"))
    assert len(kept) == 2 and kept[0] == "folder_mug_0001.ply" and kept[1].startswith("folder_mug_0001_"), kept
    assert acquire("--source", other) == {}  # all known
    solids.write_ply(other / "mug" / "0001.ply", solids.ball())
    assert len(acquire("--source", other)) == 1


def scene_of_two_buffers(mesh, uri):
    """Vertices in the file's own buffer, triangles in the one at `uri`; (scene, own buffer, other one)."""
    scene, data = scene_of(mesh)
    length = scene["bufferViews"][0]["byteLength"]
    scene["buffers"] = [{"byteLength": length}, {"byteLength": len(data) - length, "uri": uri}]
    scene["bufferViews"][1].update(buffer=1, byteOffset=0)
    return scene, data[:length], data[length:]


def test_glb_takes_buffers_of_other_files_in(voxid, acquire, folder, tmp_path):
    """The same shape three times: the second and third are told as such once they are whole."""
    (folder / "a mug.glb").write_bytes(glb(TIN))
    scene, own, other = scene_of_two_buffers(TIN, "b%201.bin")
    (folder / "b mug.glb").write_bytes(glb_of(scene, own))
    (folder / "b 1.bin").write_bytes(other)
    scene, buffer = scene_of(TIN)
    scene["buffers"][0]["uri"] = "data:;base64," + base64.b64encode(buffer).decode()
    (folder / "c mug.zip").write_bytes(packed({"x/c.glb": glb_of(scene)}))
    lines = acquire()
    assert lines["a mug"]["number"] == 1
    same = "the same shape as mug/folder_a_mug.glb"
    assert (lines["b mug"]["dropped"], lines["c mug"]["dropped"]) == (same, same)


@pytest.mark.parametrize("data", [b"glTF\x02\0\0\0" + b"\0" * 4, glb_of({"buffers": [{"uri": "x"}]}),
                                  glb_of({"buffers": [{"uri": "data:,"}], "bufferViews": [{"buffer": 7}]}),
                                  glb_of({"buffers": 7}), glb_of({"buffers": [{}, {"uri": "data:,"}]})])
def test_a_damaged_glb_is_dropped_with_a_reason(acquire, folder, data):
    solids.write_ply(folder / "mug 2.ply", CONE)
    (folder / "mug.glb").write_bytes(data)
    lines = acquire()
    assert "is no glTF" in lines["mug"]["dropped"] or "is not there" in lines["mug"]["dropped"]


@pytest.mark.parametrize("uri, reason", [("../outside.bin", "outside the source's folder"),
                                         ("/etc/passwd", "outside the source's folder"),
                                         ("link.bin", "outside the source's folder"),
                                         ("absent.bin", "is not there"), ("file:///etc/passwd", "is not there"),
                                         ("large.bin", "have more than 1048576 bytes")])
def test_gltf_that_names_what_it_must_not_have_is_dropped(acquire, folder, tmp_path, uri, reason):
    (tmp_path / "outside.bin").write_bytes(write_gltf(folder / "mug.gltf", TIN, uri))
    (folder / "link.bin").symlink_to(tmp_path / "outside.bin")
    (folder / "large.bin").write_bytes(b"\0" * (1 << 20))
    solids.write_ply(folder / "mug 2.ply", CONE)
    lines = acquire("--max-mb", 1)
    assert reason in lines["mug"]["dropped"] and lines["mug 2"]["number"] == 1
    assert not (tmp_path / "lib/mug/folder_mug.gltf").exists()


def test_the_shape_is_the_same_without_materials(voxid, acquire, folder, tmp_path):
    """What .mtl, .dae and .gltf say of colours stays behind: the one file that is kept has the whole shape."""
    vertices, triangles = TIN
    lines = ["mtllib tin.mtl", *("v %f %f %f" % v for v in vertices), "usemtl glass",
             *("f %d %d %d" % tuple(i + 1 for i in t) for t in triangles)]
    (folder / "mug.obj").write_text("\n".join(lines) + "\n")
    (folder / "tin.mtl").write_text("newmtl glass\nKd 0.1 0.2 0.3\nd 0.2\nmap_Kd wood.png\n")
    acquire()
    here, there = (voxid("describe", path, "--json").json["bins"]
                   for path in (folder / "mug.obj", tmp_path / "lib/mug/folder_mug.obj"))
    assert here == there and not list((tmp_path / "lib").rglob("*.mtl"))


def test_archives_are_unpacked_and_hostile_ones_cost_one_line(acquire, folder, tmp_path):
    (folder / "mug 1.zip").write_bytes(gltf_zip(TIN, folder="x/"))
    (folder / "mug 2.zip").write_bytes(packed({"a.ply": b"\0" * (8 << 20)}))
    (folder / "mug 3.zip").write_bytes(packed({"../../a.ply": b"ply"}))
    (folder / "mug 4.zip").write_bytes(b"PK but no more")
    (folder / "mug 5.zip").write_bytes(packed({"readme.txt": b"x"}))
    lines = acquire("--max-mb", 1)
    assert lines["mug 1"]["model"] == "mug/folder_mug_1.gltf" and lines["mug 1"]["number"] == 1
    assert {title: line["dropped"] for title, line in lines.items() if title != "mug 1"} == {
        "mug 2": "the archive unpacks to more than the limit of 1048576 bytes",
        "mug 3": "the archive names '../../a.ply', outside its own folder",
        "mug 4": "no zip archive", "mug 5": "the archive holds no mesh of a format that voxid reads"}
    assert sorted(path.name for path in tmp_path.iterdir()) == ["in", "lib"]


@pytest.mark.parametrize("below", ["", "mug"])
def test_what_lies_in_a_folder_of_the_words_name_is_called_so(voxid, tmp_path, below):
    solids.write_ply(tmp_path / "in" / "mug" / "blue.ply", TIN)
    solids.write_ply(tmp_path / "in" / "tin" / "red.ply", CONE)
    answer = voxid("acquire", "mug", "--sense", 4, "--depth", 0, "--source", tmp_path / "in" / below, "--out",
                   tmp_path / "lib", "--yes", "--json")
    assert answer.json["title"] == "blue"


def test_names_that_differ_little_are_different_models(acquire, folder):
    """In what a file's name in the library leaves out, and beyond where it is cut off."""
    solids.write_ply(folder / "mug-1.ply", TIN)
    solids.write_ply(folder / "mug 1.ply", CONE)
    deep = folder / ("d" * 90)
    solids.write_ply(deep / "mug a.ply", solids.box(1.0, 0.8, 0.3))
    solids.write_ply(deep / "b mug.ply", solids.ball())
    lines = acquire()
    assert {"mug-1", "mug 1", "b mug"} <= set(lines) and len({line["model"] for line in lines.values()}) == len(lines)
    assert all(line["number"] for line in lines.values())
    assert acquire() == {}  # and the next run knows them all


def test_any_name_of_a_file_is_one_line(voxid, folder, tmp_path):
    solids.write_ply(folder / "a\n\x1b[2J mug.ply", TIN)
    with open(os.fsencode(folder) + b"/mug \xff.ply", "wb") as file:
        file.write(b"ply")
    command = ("acquire", "mug", "--sense", 4, "--depth", 0, "--source", folder, "--out", tmp_path / "lib", "--yes")
    answer = voxid(*command)
    assert answer.code == 0 and len(answer.err.splitlines()) == 1, answer.err
    assert '"a [2J mug"' in answer.out and '"mug ?"' in answer.out and "\x1b" not in answer.out
    assert len(answer.out.splitlines()) == 2
    assert len(voxid("library", "list", tmp_path / "lib").out.splitlines()) == 2


def test_what_a_killed_run_left_half_done_is_removed(acquire, folder, tmp_path):
    (tmp_path / "lib/.work").mkdir(parents=True)
    (tmp_path / "lib/.work/0.ply").write_bytes(b"half")
    solids.write_ply(folder / "mug.ply", TIN)
    acquire()
    assert not (tmp_path / "lib/.work").exists()
