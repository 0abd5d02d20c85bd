# SPDX-License-Identifier: BSD-3-Clause
"""voxid add, remove and merge."""
import fcntl
import os
import pathlib
import re
import shutil
import subprocess

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = ROOT / os.environ.get("VOXID", pathlib.Path(os.environ.get("VOXID_BUILD", "build")) / "bin" / "voxid")


def build(voxid, models, out, *options):
    answer = voxid("build", "--models", models, "--out", out, "--views-every", 16, "--jobs", 2, *options)
    assert answer.code == 0, answer.err
    return out


@pytest.fixture(scope="module")
def halves(models, tmp_path_factory):
    """The models in two folders: all but the cubes' second and the tin; those two."""
    folder = tmp_path_factory.mktemp("halves")
    shutil.copytree(models, folder / "first")
    for category, name in [("cube", "cube_b"), ("tin", "tin_a")]:
        (folder / "second" / category).mkdir(parents=True)
        shutil.move(folder / "first" / category / f"{name}.ply", folder / "second" / category)
    (folder / "first" / "tin").rmdir()
    return folder / "first", folder / "second"


@pytest.fixture(scope="module", params=[["default"], ["paper"], ["default", "--keep-points"],
                                         ["default", "--bytes", "32"]], ids=" ".join)
def files(voxid, models, halves, tmp_path_factory, request):
    """The indices of all models and of each half."""
    folder = tmp_path_factory.mktemp("indices")
    options = ["--descriptor", *request.param]
    return [build(voxid, part, folder / f"{i}.vxi", *options) for i, part in enumerate([models, *halves])]


def copied(file, tmp_path):
    return shutil.copy(file, tmp_path / file.name)


def test_added_removed_and_merged_are_what_a_build_of_all_gives(voxid, files, halves, tmp_path):
    whole, first, second = files
    merged = tmp_path / "merged.vxi"
    assert voxid("merge", first, second, "--out", merged).code == 0
    assert merged.read_bytes() == whole.read_bytes()
    added = copied(first, tmp_path)
    answer = voxid("add", added, "--models", halves[1], "--views-every", 16)
    assert answer.code == 0 and "35 views of 7 models in 6 categories" in answer.err
    assert added.read_bytes() == whole.read_bytes()
    removed = copied(whole, tmp_path)
    assert voxid("remove", removed, "cube/cube_b", "tin").code == 0
    assert removed.read_bytes() == first.read_bytes()
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(["merged.vxi", first.name, whole.name])


@pytest.mark.parametrize("change", [["add", "FILE", "--models", "MODELS"], ["remove", "FILE", "tin"],
                                    ["merge", "FIRST", "SECOND", "--out", "FILE"]])
def test_a_full_disk_is_one_line_and_leaves_the_index(files, halves, tmp_path, change):
    file = pathlib.Path(copied(files[0], tmp_path))
    places = {"FILE": file, "MODELS": halves[1], "FIRST": files[1], "SECOND": files[2]}
    command = [str(places.get(word, word)) for word in change] + ["--replace"] * (change[0] == "add")
    run = subprocess.run(["bash", "-c", 'ulimit -f 4 && exec "$@"', "limited", PROGRAM, *command], capture_output=True,
                         text=True, timeout=120)
    assert run.returncode == 1 and re.fullmatch("voxid: .*File too large\n", run.stderr), (run.returncode, run.stderr)
    assert file.read_bytes() == files[0].read_bytes() and list(tmp_path.iterdir()) == [file]


def test_a_model_that_is_there_is_refused_or_replaced(voxid, files, halves, tmp_path):
    index = copied(files[0], tmp_path)
    before = index.read_bytes()
    voxid("add", index, "--models", halves[1], "--views-every", 16).refuses(1, "cube/cube_b", "--replace")
    assert index.read_bytes() == before and len(list(tmp_path.iterdir())) == 1
    assert voxid("add", index, "--models", halves[1], "--views-every", 16, "--replace").code == 0
    assert index.read_bytes() == before
    voxid("merge", files[0], files[1], "--out", tmp_path / "m.vxi").refuses(1, "ball/ball_a")
    assert not (tmp_path / "m.vxi").exists()


def test_what_is_not_there_cannot_be_removed(voxid, files, tmp_path):
    index = copied(files[0], tmp_path)
    before = index.read_bytes()
    voxid("remove", index, "cube", "unicorn").refuses(3, "unicorn")
    voxid("remove", index, "ball", "board", "cone", "cube", "rod", "tin").refuses(3, "no model would be left")
    voxid("remove", tmp_path / "none.vxi", "cube").refuses(1, "none.vxi")
    assert index.read_bytes() == before and len(list(tmp_path.iterdir())) == 1


def test_different_descriptors_do_not_mix(voxid, halves, tmp_path):
    default = build(voxid, halves[0], tmp_path / "d.vxi")
    paper = build(voxid, halves[1], tmp_path / "p.vxi", "--descriptor", "paper")
    packed = build(voxid, halves[1], tmp_path / "k.vxi", "--bytes", 32)
    for other in (paper, packed):
        voxid("merge", default, other, "--out", tmp_path / "m.vxi").refuses(1, other.name, "descriptors differ")


def test_two_writers_do_not_meet(voxid, files, tmp_path):
    index = copied(files[0], tmp_path)
    parts = tmp_path / (index.name + ".parts")
    parts.mkdir()
    with open(parts / "lock", "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        voxid("remove", index, "cube").refuses(1, "is running")
    (parts / "0123.shard").write_text("of an interrupted build")
    assert voxid("remove", index, "cube").code == 0
    assert (parts / "0123.shard").exists()


def test_what_killed_runs_left_is_removed(voxid, files, tmp_path):
    index = copied(files[0], tmp_path)
    added = tmp_path / (index.name + ".parts") / "added.vxi.parts"
    added.mkdir(parents=True)
    for left in (added / "0123.shard", added.parent / "draft.vxi.new-7-0", tmp_path / (index.name + ".new-7-0")):
        left.write_text("half of it")
    others = [tmp_path / name for name in ("other" + index.name + ".new-7-0", index.name + ".new-shelf")]
    for other in others:
        other.write_text("somebody's")
    assert voxid("remove", index, "cube").code == 0
    assert sorted(tmp_path.iterdir()) == sorted([index, *others])


def test_a_damaged_index_is_not_edited(voxid, files, tmp_path):
    index = copied(files[0], tmp_path)
    data = bytearray(index.read_bytes())
    data[-100] ^= 1
    index.write_bytes(data)
    voxid("remove", index, "cube").refuses(4, index.name)
