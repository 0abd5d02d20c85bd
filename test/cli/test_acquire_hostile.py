# SPDX-License-Identifier: BSD-3-Clause
"""voxid acquire on what is broken, hostile or interrupted: one line each, and the rest goes on."""
import gzip
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import time
import zipfile

import pytest

import solids

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = ROOT / os.environ.get("VOXID", pathlib.Path(os.environ.get("VOXID_BUILD", "build")) / "bin" / "voxid")
sys.path.insert(0, str(ROOT / "python"))
from voxid.acquire import command, judge  # noqa: E402

TIN = solids.turned([(0.0, 0.0), (0.4, 0.0), (0.4, 1.0), (0.0, 1.0)])
CONE = solids.turned([(0.0, 0.0), (0.5, 0.0), (0.0, 1.2)])
# Debian's Assimp follows levels by recursion.
DEEP_AC = b"AC3Db\nMATERIAL \"\" rgb 1 1 1 amb 0 0 0 emis 0 0 0 spec 0 0 0 shi 0 trans 0\n"
DEEP_AC += b"OBJECT group\nkids 1\n" * 300000
DEEP_X3D = b"<X3D><Scene>" + b"<Group>" * 300000 + b"</Group>" * 300000 + b"</Scene></X3D>"
NO_BODY = (b"ply\nformat binary_little_endian 1.0\nelement vertex 250000000\n"
           b"property float x\nproperty float y\nproperty float z\n"
           b"element face 0\nproperty list uchar int vertex_indices\nend_header\n")


def arguments(folder, library, *more):
    return ["acquire", "mug", "--sense", "4", "--depth", "0", "--source", str(folder), "--out", str(library),
            *map(str, more)]


@pytest.fixture
def folder(tmp_path):
    solids.write_ply(tmp_path / "in" / "mug 1.ply", TIN)
    solids.write_ply(tmp_path / "in" / "mug 2.ply", solids.ball())
    return tmp_path / "in"


def catalogue(path, models, properties=None):
    """A .sh3f of (name, member, data)."""
    lines = ["name=Test", "license=Public domain"]
    for number, (name, member, _) in enumerate(models, 1):
        lines += [f"name#{number}={name}", f"model#{number}=/{member}", f"creator#{number}=Ann"]
    path.parent.mkdir(parents=True, exist_ok=True)
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("PluginFurnitureCatalog.properties", "\n".join(lines) if properties is None else properties)
        for _, member, data in models:
            archive.writestr(member, data)


def ply_text(tmp_path, mesh):
    solids.write_ply(tmp_path / "text" / "x.ply", mesh)
    return (tmp_path / "text" / "x.ply").read_bytes()


def test_meshes_that_crash_their_reader_cost_one_line_each(voxid, folder, tmp_path):
    for name, data in {"mug 3.ac": DEEP_AC, "mug 4.x3d": DEEP_X3D, "mug 5.obj": b"", "mug 6.ply": NO_BODY,
                       "mug 7.glb": b"glTF"}.items():
        (folder / name).write_bytes(data)
    answer = voxid(*arguments(folder, tmp_path / "lib", "--yes", "--json"))
    assert answer.code == 0 and len(answer.err.splitlines()) == 1, answer.err
    dropped = {line["title"]: line["dropped"] for line in answer.lines if line["number"] is None}
    assert set(dropped) == {"mug 3", "mug 4", "mug 5", "mug 6", "mug 7"}
    assert "crashed" in dropped["mug 3"] and "crashed" in dropped["mug 4"]
    assert "250000000" in dropped["mug 6"] or "ends" in dropped["mug 6"] or "cut" in dropped["mug 6"], dropped["mug 6"]
    assert {path.name for path in (tmp_path / "lib/mug").glob("folder_*")} == {"folder_mug_1.ply", "folder_mug_2.ply"}


def write_program(path, body):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(f"#!/bin/bash\n{body}\n")
    path.chmod(0o755)
    return path


@pytest.mark.parametrize("body, reason", [("kill -SEGV $$", "died of SIGSEGV"), ("sleep 30", "not read within"),
                                          ("echo 'voxid: no' >&2; exit 1", "no"), ("exit 1", "ended with 1")])
def test_a_reader_that_dies_or_hangs_is_a_reason(tmp_path, monkeypatch, body, reason):
    monkeypatch.setattr(judge, "LOOK", [str(write_program(tmp_path / "look", body))])
    monkeypatch.setattr(judge, "SECONDS", 1)
    start = time.monotonic()
    verdict = judge.judge(tmp_path / "a.ply")
    assert reason in verdict.reason and verdict.shape is None
    assert time.monotonic() - start < 10


def copy_libraries_of(program, folder):
    """voxid's own, where a build made shared ones: the reader is looked for from where the code lies."""
    folder.mkdir(exist_ok=True)
    loaded = subprocess.run(["ldd", program], capture_output=True, text=True, check=True).stdout
    for library in re.findall(r"=> (\S*/libvoxid_\S+)", loaded):
        shutil.copy(library, folder)
    return folder


@pytest.mark.parametrize("reader, reason", [(None, "not there"), ("exit 127", "a library is not there")])
def test_a_voxid_without_its_reader_ends_the_run_and_settles_nothing(folder, tmp_path, reader, reason):
    """A broken installation: bin/voxid and its Python without a lib/voxid/voxid_read_mesh that starts."""
    (folder / "mug 3.obj").write_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 1\nf 1 2 3\nf 1 2 4\nf 2 3 4\nf 1 3 4\n")
    (tmp_path / "usr/bin").mkdir(parents=True)
    program = pathlib.Path(shutil.copy(PROGRAM, tmp_path / "usr/bin/voxid"))
    shutil.copytree(PROGRAM.parents[1] / "python", tmp_path / "usr/python")
    shutil.copytree(ROOT / "cfg", tmp_path / "cfg")
    if reader:
        write_program(tmp_path / "usr/lib/voxid/voxid_read_mesh", reader)
    libraries = copy_libraries_of(program, tmp_path / "usr/lib")
    words = [program, *arguments(folder, tmp_path / "lib", "--yes")]
    run = subprocess.run(words, capture_output=True, text=True, timeout=60,
                         env={**os.environ, "LD_LIBRARY_PATH": str(libraries)})
    assert run.returncode == 1 and len(run.stderr.splitlines()) == 1, run.stderr
    assert run.stderr.startswith("voxid: cannot start lib/voxid/voxid_read_mesh") and reason in run.stderr
    assert run.stdout == ""
    assert [path.name for path in (tmp_path / "lib").iterdir()] == [".lock"]


def test_a_module_that_cannot_be_loaded_says_nothing_of_a_mesh(tmp_path, monkeypatch):
    program = write_program(tmp_path / "look", "echo 'cannot be loaded (libembree3.so.3: not there)' >&2; exit 127")
    monkeypatch.setattr(judge, "LOOK", [str(program)])
    with pytest.raises(judge.NoReader, match="libembree3"):
        judge.judge(tmp_path / "a.ply")


@pytest.mark.parametrize("command", ["acquire", "build"])
def test_a_voxid_without_its_compiled_module_is_one_sentence(folder, tmp_path, command):
    (tmp_path / "usr/bin").mkdir(parents=True)
    program = shutil.copy(PROGRAM, tmp_path / "usr/bin/voxid")
    shutil.copytree(ROOT / "python", tmp_path / "usr/python")
    shutil.copytree(ROOT / "cfg", tmp_path / "cfg")
    words = {"acquire": arguments(folder, tmp_path / "lib", "--yes"),
             "build": ["build", "--models", folder, "--out", tmp_path / "a.vxi", "--workers", "1"]}
    run = subprocess.run([program, *words[command]], capture_output=True, text=True, timeout=60)
    (line,) = run.stderr.splitlines()
    assert run.returncode == 1 and line.startswith("voxid: voxid's compiled part cannot be loaded"), line


def test_a_build_without_its_reader_says_so_of_each_mesh_that_needs_it(folder, tmp_path):
    program = pathlib.Path(shutil.copy(PROGRAM, tmp_path / "voxid"))
    libraries = copy_libraries_of(program, tmp_path / "lib")
    models = tmp_path / "models"
    (models / "tin").mkdir(parents=True)
    shutil.copy(folder / "mug 1.ply", models / "tin")
    (models / "tin" / "other.obj").write_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n")
    run = subprocess.run([program, "build", "--models", models, "--out", tmp_path / "a.vxi", "--views-every", "40"],
                         capture_output=True, text=True, timeout=60,
                         env={**os.environ, "LD_LIBRARY_PATH": str(libraries)})
    skipped, built = run.stderr.splitlines()
    assert skipped.startswith("voxid: skipped tin/other.obj: cannot start lib/voxid/voxid_read_mesh"), skipped
    assert run.returncode == 0 and "2 views of 1 model in 1 category" in built, built


def test_a_needle_is_drawn(folder, tmp_path):
    """A pixel wide where it is seen."""
    solids.write_ply(folder / "needle.ply", solids.box(1.0, 0.0015, 0.0015))
    verdict = judge.judge(folder / "needle.ply")
    assert verdict.reason in ("", "shows nothing") and verdict.thumbnail.shape == (160, 160)


def test_a_catalogue_with_a_bomb_and_a_name_that_leads_out(voxid, tmp_path):
    sound = ply_text(tmp_path, TIN)
    catalogue(tmp_path / "bomb" / "a.sh3f", [("mug", "x/a.ply", sound), ("mug", "x/b.ply", b"\0" * (20 << 20))])
    answer = voxid(*arguments(tmp_path / "bomb", tmp_path / "lib", "--yes", "--json", "--max-mb", 5))
    assert answer.code == 0, answer.err
    assert {line["model"]: line.get("dropped", "") for line in answer.lines} == {
        "mug/sh3d_x_a.ply": "", "mug/sh3d_x_b.ply": "the archive unpacks to more than the limit of 5242880 bytes"}
    catalogue(tmp_path / "out" / "a.sh3f", [("mug", "../../up/c.ply", ply_text(tmp_path, CONE))])
    answer = voxid(*arguments(tmp_path / "out", tmp_path / "lib", "--yes", "--json"))
    assert "outside its own folder" in answer.lines[0]["dropped"]
    assert sorted(path.name for path in tmp_path.iterdir()) == ["bomb", "lib", "out", "text"]


@pytest.mark.parametrize("data", [b"", b"PK", b"PK\x05\x06" + b"\xff" * 18])
def test_a_damaged_catalogue_is_one_line_and_the_other_source_goes_on(voxid, folder, tmp_path, data):
    (tmp_path / "cat").mkdir()
    (tmp_path / "cat" / "a.sh3f").write_bytes(data)
    answer = voxid(*arguments(tmp_path / "cat", tmp_path / "lib", "--source", folder, "--yes"))
    assert answer.code == 0 and "Traceback" not in answer.err
    assert sum("no Sweet Home 3D catalogue" in line for line in answer.err.splitlines()) == 1


def objaverse(root, packed):
    solids.write_ply(root / "glbs" / "000-000" / "u1.ply", TIN)
    solids.write_ply(root.parent / "outside.ply", CONE)
    texts = {"object-paths.json": {"u1": "glbs/000-000/u1.ply", "u2": "../outside.ply", "u3": "glbs/absent.glb"},
             "metadata/000-000.json": {
                 "u1": {"name": "Coffee mug", "license": "by", "user": {"displayName": "Bo"},
                        "viewerUrl": "https://example.org/u1"},
                 "u2": {"name": "Mug"}, "u3": {"name": "Mug"}, "u4": 7, "u5": {"name": None}, "u6": {"name": "Car"}}}
    (root / "metadata").mkdir()
    for name, value in texts.items():
        text = json.dumps(value).encode()
        (root / (name + ".gz" * packed)).write_bytes(gzip.compress(text) if packed else text)


@pytest.mark.parametrize("packed", [True, False])
def test_an_objaverse_mirror_gives_licence_and_author_and_nothing_outside_itself(voxid, tmp_path, packed):
    objaverse(tmp_path / "mirror", packed)
    answer = voxid(*arguments(tmp_path / "mirror", tmp_path / "lib", "--yes", "--json"))
    found = [(line["model"], line["licence"], line["author"]) for line in answer.lines]
    assert found == [("mug/objaverse_u1.ply", "by", "Bo")], answer.err
    if packed:
        file = tmp_path / "mirror/metadata/000-000.json.gz"
        file.write_bytes(file.read_bytes()[:-20])
        answer = voxid(*arguments(tmp_path / "mirror", tmp_path / "lib2", "--yes"))
        assert answer.code == 1 and "000-000.json.gz is no JSON" in answer.err and "Traceback" not in answer.err


def test_shapenet_takes_what_its_taxonomy_has_below_the_synset(voxid, tmp_path):
    mirror = tmp_path / "mirror"
    for offset, mesh in (("03797390", TIN), ("04999999", CONE), ("02876657", solids.ball())):
        solids.write_ply(mirror / offset / "m" / "models" / "model_normalized.ply", mesh)
    (mirror / "taxonomy.json").write_text(json.dumps([{"synsetId": "03797390", "name": "mug", "children": ["04999999"]},
                                                      {"synsetId": "04999999", "name": "tankard",
                                                       "children": ["03797390"]}]))
    answer = voxid(*arguments(mirror, tmp_path / "lib", "--yes", "--json"))
    found = {line["model"] for line in answer.lines}
    assert found == {"mug/shapenet_03797390_m.ply", "mug/shapenet_04999999_m.ply"}, answer.err
    for text in ("[1]", "{}"):
        (mirror / "taxonomy.json").write_text(text)
        answer = voxid(*arguments(mirror, tmp_path / "lib2", "--yes"))
        assert answer.code == 1 and "taxonomy.json is not a list" in answer.err


def test_keep_takes_the_numbers_and_settles_the_rest(voxid, folder, tmp_path):
    solids.write_ply(folder / "mug 3.ply", CONE)
    command_line = arguments(folder, tmp_path / "lib", "--json")
    voxid(*command_line, "--keep", "1,9").refuses(2, "'9'")
    answer = voxid(*command_line, "--keep", "1,3")
    assert answer.code == 0, answer.err
    notes = json.loads((tmp_path / "lib/library.json").read_text())
    verdicts = {note["verdict"] for note in notes.values() if "verdict" in note}
    assert verdicts == {"kept", "dropped: by hand"}
    assert len(list((tmp_path / "lib/mug").glob("*.ply"))) == 2
    assert voxid(*command_line, "--yes").lines == []  # all three are settled
    assert len(list((tmp_path / "lib/mug").glob("*.ply"))) == 2


def test_what_is_settled_is_not_read_again(folder, tmp_path, monkeypatch):
    """Only new candidates are looked at."""
    log = tmp_path / "log"
    program = write_program(tmp_path / "look", f'echo "$1" >> {log}\nexec {" ".join(judge.LOOK)} "$@"')
    monkeypatch.setattr(judge, "LOOK", [str(program)])
    run = lambda: command.run(str(PROGRAM), arguments(folder, tmp_path / "lib", "--yes")[1:])
    assert run() == 0
    log.write_text("")
    before = {path: path.stat().st_mtime_ns
              for path in (tmp_path / "lib").rglob("*") if path.name != ".lock" and path.is_file()}
    assert run() == 0 and log.read_text() == ""
    assert {path: path.stat().st_mtime_ns for path in before} == before
    solids.write_ply(folder / "mug 3.ply", CONE)
    assert run() == 0
    assert len(log.read_text().splitlines()) == 1
    assert len(list((tmp_path / "lib/mug").glob("*.ply"))) == 3


def test_a_full_disk_is_one_line_and_settles_nothing(folder, tmp_path):
    limit = ["bash", "-c", 'ulimit -f 1 && exec "$@"', "limited", str(PROGRAM)]
    run = subprocess.run(limit + arguments(folder, tmp_path / "lib", "--yes"), capture_output=True, text=True,
                         timeout=60)
    (line,) = run.stderr.splitlines()
    assert run.returncode == 1 and line.startswith(f"voxid: {tmp_path / 'lib'}") and "too large" in line
    assert not (tmp_path / "lib" / "library.json").exists()


@pytest.mark.parametrize("wait_s", [0.1, 0.3])
def test_interrupted_at_any_moment_it_says_so_and_the_next_run_completes_it(voxid, folder, tmp_path, wait_s):
    """Also while its modules load."""
    library = tmp_path / "lib"
    running = subprocess.Popen([str(PROGRAM), *arguments(folder, library, "--yes")], stdout=subprocess.DEVNULL,
                               stderr=subprocess.PIPE, text=True)
    time.sleep(wait_s)
    running.send_signal(signal.SIGINT)
    said = running.communicate(timeout=60)[1]
    # Before its own code has begun the signal ends it without a word, as it does any program.
    assert (running.returncode, said) in [(1, "voxid: interrupted\n"), (-signal.SIGINT, "")] or running.returncode == 0
    assert not (library / ".work").exists()
    assert voxid(*arguments(folder, library, "--yes")).code == 0
    assert len(json.loads((library / "library.json").read_text())) == 3


def test_killed_at_any_moment_the_next_run_completes_it(voxid, folder, tmp_path):
    library = tmp_path / "lib"
    for wait_s in (0.3, 0.8, 1.3):
        running = subprocess.Popen([str(PROGRAM), *arguments(folder, library, "--yes")], stdout=subprocess.DEVNULL,
                                   stderr=subprocess.DEVNULL)
        time.sleep(wait_s)
        running.kill()
        running.wait()
    answer = voxid(*arguments(folder, library, "--yes"))
    assert answer.code == 0, answer.err
    notes = json.loads((library / "library.json").read_text())
    assert set(notes) == {"mug", "mug/folder_mug_1.ply", "mug/folder_mug_2.ply"}
    assert voxid("build", "--models", library, "--out", tmp_path / "a.vxi", "--views-every", 16).code == 0
