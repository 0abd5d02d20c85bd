# SPDX-License-Identifier: BSD-3-Clause
"""voxid build: same bytes whatever happens on the way, and a reason for every model that is left out."""
import contextlib
import json
import os
import pathlib
import pty
import re
import signal
import struct
import subprocess
import time

import pytest

import solids

ROOT = pathlib.Path(__file__).resolve().parents[2]
CRASHER = ROOT / "../shared/data/models/train/screw/base_screw_head.ply"
PROGRAM = ROOT / os.environ.get("VOXID", pathlib.Path(os.environ.get("VOXID_BUILD", "build")) / "bin" / "voxid")


def build(voxid, models, out, *more):
    return voxid("build", "--models", models, "--out", out, "--views-every", 4, *more)


def nothing_left_beside(out):
    return sorted(path.name for path in out.parent.iterdir() if path != out) == []


def sections_of(index, *tags):
    """Their bytes (doc/index_format.md)."""
    entries = struct.iter_unpack("<4s4xQQ8x", index[64:64 + 32 * struct.unpack_from("<I", index, 24)[0]])
    places = {tag.decode(): slice(offset, offset + length) for tag, offset, length in entries}
    return [index[places[tag]] for tag in tags]


@pytest.fixture
def out(tmp_path):
    (tmp_path / "out").mkdir()
    return tmp_path / "out" / "index.vxi"


@pytest.fixture(scope="module")
def expected(voxid, models, tmp_path_factory):
    path = tmp_path_factory.mktemp("expected") / "index.vxi"
    assert build(voxid, models, path, "--jobs", 1).code == 0
    return path.read_bytes()


@pytest.mark.parametrize("jobs", [2, 5])
def test_bytes_do_not_depend_on_the_number_of_jobs(voxid, models, out, expected, jobs):
    assert build(voxid, models, out, "--jobs", jobs).code == 0
    assert out.read_bytes() == expected
    assert nothing_left_beside(out)


def test_kept_surfaces_do_not_depend_on_the_number_of_jobs_and_leave_the_views_alone(voxid, models, out, expected):
    assert build(voxid, models, out, "--keep-points", "--jobs", 1).code == 0
    kept = out.read_bytes()
    assert build(voxid, models, out, "--keep-points", "--jobs", 5).code == 0
    assert out.read_bytes() == kept
    line = voxid("info", out, "--json").json
    assert line["surfaces"] == line["models"] == 7
    assert all(section in kept for section in sections_of(expected, "VIE4", "CODE", "KEYS", "BKTV"))


def test_bytes_do_not_depend_on_where_the_models_lie_or_on_links(voxid, models, out, expected, tmp_path):
    elsewhere = tmp_path / "elsewhere"
    for file in models.glob("*/*.ply"):
        (elsewhere / file.parent.name).mkdir(parents=True, exist_ok=True)
        (elsewhere / file.parent.name / file.name).symlink_to(file)
    assert build(voxid, elsewhere, out).code == 0
    assert out.read_bytes() == expected


def test_what_is_built_passes_verify_and_counts(voxid, models, out, expected):
    out.write_bytes(expected)
    assert voxid("verify", out).code == 0
    info = voxid("info", out, "--json").json
    assert (info["models"], info["categories"], info["views"]) == (7, 6, 7 * 20)


def test_a_killed_build_goes_on_and_gives_the_same_bytes(voxid, models, out, expected):
    command = [PROGRAM, "build", "--models", models, "--out", out, "--views-every", "4", "--jobs", "1"]
    running = subprocess.Popen([str(part) for part in command], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    parts = pathlib.Path(f"{out}.parts")
    deadline = time.time() + 60
    while len(list(parts.glob("*.shard"))) < 2 and running.poll() is None and time.time() < deadline:
        time.sleep(0.005)
    running.send_signal(signal.SIGKILL)
    running.wait()
    kept = {path: path.stat().st_mtime_ns for path in parts.glob("*.shard")}
    assert kept and not out.exists()
    deadline = time.time() + 10  # the worker ends with its parent, and with it the lock
    answer = build(voxid, models, out, "--resume")
    while answer.code == 1 and "is running" in answer.err and time.time() < deadline:
        answer = build(voxid, models, out, "--resume")
    assert answer.code == 0, answer.err
    assert out.read_bytes() == expected
    assert nothing_left_beside(out)


@pytest.mark.parametrize("left", ["{}.new-7-0", "{}.parts/draft.vxi.new-7-0", "{}.parts/added.vxi.parts/0.shard"])
@pytest.mark.parametrize("resume", [[], ["--resume"]], ids=["anew", "resumed"])
def test_what_killed_runs_left_is_removed(voxid, models, out, expected, left, resume):
    stray = pathlib.Path(left.format(out))
    stray.parent.mkdir(parents=True, exist_ok=True)
    stray.write_text("half of an index")
    assert build(voxid, models, out, *resume).code == 0
    assert out.read_bytes() == expected
    assert nothing_left_beside(out)


def test_only_a_file_is_replaced(voxid, models, out, tmp_path):
    """A rename would do away with a device as well; a folder it refuses, but only after all models are rendered."""
    os.mkfifo(out)
    build(voxid, models, out).refuses(1, out, "no regular file")
    assert out.is_fifo() and nothing_left_beside(out)
    build(voxid, models, tmp_path / "out").refuses(1, tmp_path / "out", "is a folder")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["out"]
    voxid("train", "--models", models, "-o", out).refuses(1, out, "no regular file")
    assert out.is_fifo()


def limited(kib, models, out):
    """The command line of a build that may write no file larger than `kib`, as on a full disk."""
    command = ["bash", "-c", 'ulimit -f "$0" && exec "$@"', kib, PROGRAM, "build", "--models", models, "--out", out,
               "--views-every", 4]
    return [str(part) for part in command]


def test_damaged_shards_are_made_anew(voxid, models, out, expected):
    assert subprocess.run(limited(30, models, out), capture_output=True, timeout=120).returncode == 1
    shards = sorted(pathlib.Path(f"{out}.parts").glob("*.shard"))
    assert len(shards) == 7
    for number, shard in enumerate(shards[:5]):
        shard.write_bytes(shard.read_bytes()[:number * 1000])
    flipped = bytearray(shards[5].read_bytes())
    flipped[1000] ^= 1
    shards[5].write_bytes(flipped)
    assert build(voxid, models, out, "--resume").code == 0
    assert out.read_bytes() == expected


def test_a_name_with_a_line_end_is_one_line(voxid, out, tmp_path):
    solids.write_ply(tmp_path / "in" / "ball" / "a.ply", solids.ball())
    (tmp_path / "in" / "ball" / "b\n\x1b[2J.ply").write_text("ply")
    answer = build(voxid, tmp_path / "in", out)
    assert answer.code == 0 and answer.err.splitlines()[0].startswith("voxid: skipped ball/b  [2J.ply: ")
    assert len(answer.err.splitlines()) == 2


@pytest.mark.parametrize("kib", [1, 30])
def test_a_full_disk_is_one_line_and_leaves_the_old_index(voxid, models, out, expected, kib):
    """At 1 KiB no shard fits; at 30 KiB shards fit and the index does not."""
    out.write_bytes(expected)
    run = subprocess.run(limited(kib, models, out), capture_output=True, text=True, timeout=120)
    assert run.returncode == 1
    (line,) = run.stderr.splitlines()
    assert line.startswith("voxid: ") and "too large" in line
    assert out.read_bytes() == expected


def test_two_builds_of_one_index_do_not_meet(voxid, models, out):
    first = subprocess.Popen([str(PROGRAM), "build", "--models", str(models), "--out", str(out), "--jobs", "1"],
                             stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    parts = pathlib.Path(f"{out}.parts")
    while not list(parts.glob("*.shard")) and first.poll() is None:
        time.sleep(0.005)
    build(voxid, models, out).refuses(1, out, "is running")
    assert first.wait() == 0 and out.exists()


def test_bad_meshes_are_listed_and_the_rest_is_built(voxid, out, tmp_path):
    models = tmp_path / "models"
    solids.write_ply(models / "cube" / "cube_a.ply", solids.box(1, 1, 1))
    (models / "cube" / "empty.obj").write_text("")
    (models / "cube" / "cut.ply").write_text((models / "cube" / "cube_a.ply").read_text()[:-30])
    (models / "cube" / "flat.ply").write_text("ply\nformat ascii 1.0\nelement vertex 1\n"
                                              "property float x\nproperty float y\nproperty float z\n"
                                              "element face 1\nproperty list uchar int vertex_indices\n"
                                              "end_header\n0 0 0\n3 0 0 0\n")
    (models / "cube" / "cube_a.stl").write_text("solid nothing\nendsolid nothing\n")
    (models / "cube" / "picture.png").write_bytes(b"not a mesh, not looked at")
    (models / "void").mkdir()
    (models / "broken").mkdir()
    (models / "broken" / "a.obj").write_text("f 1 2 3\n")
    answer = build(voxid, models, out, "--json")
    assert answer.code == 0
    done = answer.lines[-1]
    assert (done["event"], done["models"], done["views"], done["categories"]) == ("done", 1, 20, 1)
    assert done["bytes"] == out.stat().st_size
    reasons = {skipped["model"]: skipped["reason"] for skipped in done["skipped"]}
    assert list(reasons) == ["broken/a.obj", "cube/cube_a.stl", "cube/cut.ply", "cube/empty.obj", "cube/flat.ply"]
    assert all(reasons.values())
    assert "same name" in reasons["cube/cube_a.stl"]
    assert done["empty_categories"] == ["broken", "void"]
    for name in [*reasons, "broken", "void"]:
        assert name in answer.err


def test_a_file_that_crashes_its_reader_costs_itself(voxid, out, tmp_path):
    """Assimp of Debian 12 dies of this sound PLY; under another name's ending voxid's own reader does not step in."""
    if not CRASHER.exists():
        pytest.skip(f"{CRASHER} is not there")
    solids.write_ply(tmp_path / "models" / "cube" / "cube_a.ply", solids.box(1, 1, 1))
    (tmp_path / "models" / "screw").mkdir()
    (tmp_path / "models" / "screw" / "own.ply").symlink_to(CRASHER.resolve())
    (tmp_path / "models" / "screw" / "forced.off").symlink_to(CRASHER.resolve())
    answer = build(voxid, tmp_path / "models", out, "--json")
    done = answer.lines[-1]
    assert answer.code == 0 and done["models"] == 2
    assert [skipped["model"] for skipped in done["skipped"]] == ["screw/forced.off"]


def test_a_terminal_sees_a_bar_that_has_left_before_the_report(out, tmp_path):
    solids.write_ply(tmp_path / "in" / "cube" / "a.ply", solids.box(1, 1, 1))
    (tmp_path / "in" / "cube" / "b.ply").write_text("ply")
    ours, theirs = pty.openpty()
    words = [PROGRAM, "build", "--models", tmp_path / "in", "--out", out, "--views-every", 16]
    running = subprocess.Popen([str(word) for word in words], stdout=subprocess.PIPE, stderr=theirs)
    os.close(theirs)
    said = b""
    with contextlib.suppress(OSError):  # how a terminal ends that nobody writes to any more
        while block := os.read(ours, 4096):
            said += block
    os.close(ours)
    assert running.wait(timeout=60) == 0 and running.stdout.read() == b""
    bar, report = said.decode().rsplit("\r\x1b[K", 1)
    assert re.search(r"\[#+\] 2/2 models, \d+ views/s, 0:00 left, 1 skipped$", bar), bar
    assert re.fullmatch(r"voxid: skipped cube/b.ply: .*\r\n"
                        r"voxid: .*: 5 views of 1 model in 1 category, .*\r\n", report), report


def test_without_a_terminal_only_the_report_is_said(voxid, models, out):
    answer = build(voxid, models, out)
    assert answer.out == "" and answer.err.startswith(f"voxid: {out}: 140 views of 7 models in 6 categories")
    assert len(answer.err.splitlines()) == 1


def test_no_model_left(voxid, out, tmp_path):
    (tmp_path / "models" / "cube").mkdir(parents=True)
    build(voxid, tmp_path / "models", out).refuses(3, "no mesh")
    (tmp_path / "models" / "cube" / "empty.obj").write_text("")
    build(voxid, tmp_path / "models", out).refuses(3, "cube/empty.obj")
    assert not out.exists() and nothing_left_beside(out)


def test_bad_use(voxid, models, out, tmp_path):
    build(voxid, tmp_path / "absent", out).refuses(1, "absent")
    build(voxid, models, tmp_path / "absent" / "x.vxi").refuses(1, "absent")
    build(voxid, models, out, "--jobs", 0).refuses(2, "--jobs")
    voxid("build", "--models", models).refuses(2, "--out")


def test_synsets_of_known_categories_come_from_the_shipped_table(voxid, out, tmp_path):
    models = tmp_path / "models"
    solids.write_ply(models / "mug" / "a.ply", solids.turned([(0.0, 0.0), (0.4, 0.0), (0.4, 1.0)]))
    solids.write_ply(models / "widget" / "b.ply", solids.box(1, 1, 1))
    assert build(voxid, models, out).code == 0
    info = voxid("info", out, "--json", "--categories").json
    assert info["version"] == "1.3"
    named = {entry["name"]: (entry["synset"], entry["sense"]) for entry in info["category_list"]}
    assert named == {"mug": (3797390, "mug.n.04"), "widget": (0, "")}
    assert b"instrumentality.n.03/container.n.01/vessel.n.03/drinking_vessel.n.01/mug.n.04\0" in out.read_bytes()


def test_licence_origin_and_synset_arrive_in_the_index(voxid, out, tmp_path):
    models = tmp_path / "models"
    solids.write_ply(models / "mug" / "a.ply", solids.turned([(0.0, 0.0), (0.4, 0.0), (0.4, 1.0)]))
    solids.write_ply(models / "cube" / "b.ply", solids.box(1, 1, 1))
    (models / "library.json").write_text(json.dumps({
        "mug/a.ply": {"licence": "CC-BY-4.0", "author": "Ann", "source": "a shelf", "url": "https://example.org/",
                      "synset": "n03797390"}}))
    assert build(voxid, models, out).code == 0
    info = voxid("info", out, "--json", "--categories").json
    assert {"licence": "CC-BY-4.0", "models": 1} in info["licences"]
    assert b"Ann; a shelf; https://example.org/\0" in out.read_bytes()
    assert [(entry["name"], entry["synset"]) for entry in info["category_list"]] == [("cube", 0), ("mug", 3797390)]
    (models / "library.json").write_text("[1, 2")
    build(voxid, models, out).refuses(4, "library.json")
