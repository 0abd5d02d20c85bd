# SPDX-License-Identifier: BSD-3-Clause
"""voxid segment: what it prints, draws and writes, and how it ends."""
import json
import os
import pathlib
import shutil
import subprocess

import cv2
import numpy as np
import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = ROOT / os.environ.get("VOXID", pathlib.Path(os.environ.get("VOXID_BUILD", "build")) / "bin" / "voxid")
MOSD = pathlib.Path("../shared/data/scenes/mosd")
CAMERA = "525,525,319.5,239.5"


def table_mm(height=480, width=640):
    """A plane 0.6 m below a camera that looks 40 degrees down, whole millimetres."""
    v = (np.arange(height) - 239.5) / 525
    down = np.sin(np.radians(40)) + v * np.cos(np.radians(40))
    depth = np.where(down > 0.4, 600 / np.maximum(down, 0.4), 0)
    return np.repeat(depth.round().astype(np.uint16)[:, None], width, axis=1)


@pytest.fixture
def empty_table(depth_file):
    return depth_file("empty.png", table_mm())


@pytest.fixture
def block(depth_file):
    """A patch that stands 60 to 80 mm before the table's plane."""
    pixels = table_mm()
    pixels[200:280, 300:400] -= 70
    return depth_file("block.png", pixels)


def test_json_has_every_field(voxid, scene):
    frame = voxid("segment", scene, "--json").json
    assert list(frame) == ["file", "status", "table", "objects", "dropped"]
    assert frame["file"] == str(scene) and frame["status"] == "OK"
    assert list(frame["table"]) == ["normal", "distance_m", "outline", "residual_mm", "inliers"]
    assert np.linalg.norm(frame["table"]["normal"]) == pytest.approx(1, abs=1e-4)
    for corner in frame["table"]["outline"]:
        assert np.dot(frame["table"]["normal"], corner) == pytest.approx(-frame["table"]["distance_m"], abs=3e-4)
    assert len(frame["objects"]) == 2
    for number, thing in enumerate(frame["objects"], 1):
        assert list(thing) == ["id", "pixels", "box_px", "centroid_m", "extents_m", "truncated"]
        assert thing["id"] == number and thing["truncated"] is False
    assert set(frame["dropped"]) == {"too_few_points", "outside_outline", "too_many"}


def test_labels_are_the_objects_pixels(voxid, scene, tmp_path):
    frame = voxid("segment", scene, "--json", "--labels", tmp_path / "labels").json
    labels = cv2.imread(str(tmp_path / "labels" / scene.with_suffix(".png").name), cv2.IMREAD_UNCHANGED)
    assert labels.dtype == np.uint16 and labels.shape == (480, 640)
    assert set(np.unique(labels)) == {0} | {thing["id"] for thing in frame["objects"]}
    for thing in frame["objects"]:
        rows, columns = np.nonzero(labels == thing["id"])
        assert len(rows) == thing["pixels"]
        left, top, width, height = thing["box_px"]
        assert (columns.min(), rows.min(), np.ptp(columns) + 1, np.ptp(rows) + 1) == (left, top, width, height)


def test_frames_come_in_order_and_the_run_succeeds_if_one_has_an_object(voxid, empty_table, block):
    answer = voxid("segment", empty_table, block, empty_table, "--json")
    assert answer.code == 0
    assert [frame["status"] for frame in answer.lines] == ["EMPTY_TABLE", "OK", "EMPTY_TABLE"]
    assert [frame["file"] for frame in answer.lines] == [str(empty_table), str(block), str(empty_table)]


def test_nothing_found_ends_with_3_and_still_prints(voxid, empty_table, depth_file):
    answer = voxid("segment", empty_table, "--json")
    assert answer.lines[0]["status"] == "EMPTY_TABLE" and answer.lines[0]["table"]["inliers"] > 100000
    answer.refuses(3, "EMPTY_TABLE", empty_table)
    answer = voxid("segment", depth_file("black.png", np.zeros((480, 640), np.uint16)), "--json")
    assert answer.lines[0]["status"] == "NO_DEPTH" and answer.lines[0]["table"] is None
    answer.refuses(3, "NO_DEPTH")
    noise = np.random.default_rng(1).integers(400, 2400, (480, 640)).astype(np.uint16)
    voxid("segment", depth_file("noise.png", noise), "--json").refuses(3, "NO_TABLE")


def test_float_metres_give_the_same_objects(voxid, block, depth_file):
    metres = cv2.imread(str(block), cv2.IMREAD_UNCHANGED).astype(np.float32) / 1000
    metres[metres == 0] = np.nan
    from_mm = voxid("segment", block, "--json").json
    from_m = voxid("segment", depth_file("block.tiff", metres), "--json").json
    assert from_mm["objects"] and {**from_m, "file": ""} == {**from_mm, "file": ""}


def test_twice_the_same_line(voxid, scene):
    assert voxid("segment", scene, "--json").out == voxid("segment", scene, "--json").out


def test_for_people(voxid, block):
    answer = voxid("segment", block, "--timing")
    assert answer.code == 0
    assert "OK" in answer.out and "object 1" in answer.out and "segment_ms" in answer.out


def test_settings(voxid, block):
    voxid("segment", block, "--set", "min_height_mm=100").refuses(3, "EMPTY_TABLE")
    voxid("segment", block, "--set", "min_height_mm=1").refuses(2, "min_height_mm", "2 to 100")
    voxid("segment", block, "--set", "min_height_mm=x").refuses(2, "min_height_mm")
    voxid("segment", block, "--set", "join=2").refuses(2, "join", "0 to 1")
    voxid("segment", block, "--set", "height=8").refuses(2, "height", "min_height_mm")


def test_up_tells_a_wall_from_a_table(voxid, depth_file):
    flat = depth_file("flat.png", np.full((480, 640), 1000, np.uint16))
    assert voxid("segment", flat, "--up", "0,0,-2", "--json").lines[0]["status"] == "EMPTY_TABLE"
    voxid("segment", flat, "--up", "0,-1,0", "--json").refuses(3, "NO_TABLE")
    voxid("segment", flat, "--up", "-0.5,0,-1", "--json").refuses(3, "EMPTY_TABLE")  # 27 degrees
    voxid("segment", flat, "--up", "-0.7,0,-1", "--json").refuses(3, "NO_TABLE")  # 35 degrees
    for wrong in ("0,-1", "0,-1,0,0", "up", "0,0,0", "0,nan,1"):
        voxid("segment", flat, "--up", wrong).refuses(2, "--up", "X,Y,Z")
    voxid("segment", "--evaluate", "test", "--up", "0,-1,0").refuses(2, "--up")


def test_plot(voxid, block, scene, tmp_path):
    assert voxid("segment", block, "--plot", tmp_path / "one.png").code == 0
    picture = cv2.imread(str(tmp_path / "one.png"))
    assert picture.shape == (480, 640, 3)
    assert np.ptp(picture[200:280, 300:400].astype(int), axis=2).max() > 30  # the object has a colour
    assert np.ptp(picture[400:, :100].astype(int), axis=2).max() < 10        # the table has none
    assert voxid("segment", block, scene, "--plot", tmp_path / "many.png").code == 0
    assert (tmp_path / f"many-{scene.stem}.png").exists() and (tmp_path / "many-block.png").exists()
    voxid("segment", block, "--plot", tmp_path / "none" / "x.png").refuses(1, "x.png")


def test_nothing_is_written_over_a_frame_or_over_what_another_frame_gave(voxid, block, tmp_path):
    frame = block.read_bytes()
    voxid("segment", block, "--labels", block.parent).refuses(2, block, "a frame itself")
    voxid("segment", block, "--plot", f"{block.parent}/./{block.name}").refuses(2, block.name, "a frame itself")
    assert block.read_bytes() == frame
    others = [tmp_path / name / "block.png" for name in "ab"]
    for other in others:
        other.parent.mkdir()
        other.write_bytes(frame)
    camera = ("--camera", CAMERA)
    for option in (("--labels", tmp_path / "l"), ("--plot", tmp_path / "p.png")):
        voxid("segment", *others, *camera, *option).refuses(2, "block.png", "two frames of one name")
        assert voxid("segment", others[0], others[0], *camera, *option).code == 0
    assert (tmp_path / "l/block.png").exists() and (tmp_path / "p-block.png").exists()


def test_a_name_that_is_no_utf_8_leaves_the_json_sound(block):
    name = os.fsencode(block.parent / "block") + b"\xff.png"
    shutil.copy(block, name)
    run = subprocess.run([PROGRAM, "segment", name, "--json"], capture_output=True, timeout=60)
    assert run.returncode == 0 and json.loads(run.stdout)["file"].endswith("block\ufffd.png"), run.stderr


def test_bad_use(voxid, tmp_path):
    voxid("segment").refuses(2, "FILES")
    voxid("segment", "--evaluate", "test").refuses(1, "objects.json")
    for option in ("--camera", "--labels", "--plot"):
        voxid("segment", "--evaluate", "test", option, CAMERA).refuses(2, option)


def test_truth_that_lacks_a_field_is_damaged(voxid, put_labelled_table, tmp_path):
    put_labelled_table(tmp_path, "one")
    (tmp_path / "objects.json").write_text('{"one": {"objects": [{"id": 2}]}}')
    voxid("segment", "--evaluate", tmp_path).refuses(4, tmp_path / "objects.json", "truncated")
    (tmp_path / "objects.json").write_text("{}")
    voxid("segment", "--evaluate", tmp_path).refuses(3, "objects.json", "no scene")


def needs_mosd():
    if not MOSD.is_dir():
        pytest.skip(f"{MOSD} is not there: no real scenes")


def test_real_boxes(voxid):
    needs_mosd()
    frame = voxid("segment", MOSD / "learn0_depth.png", "--camera", CAMERA, "--json").json
    assert len(frame["objects"]) == 2
    assert frame["table"]["distance_m"] == pytest.approx(0.612, abs=0.005)


def test_evaluation_of_the_real_scenes(voxid):
    needs_mosd()
    score = voxid("segment", "--evaluate", MOSD, "--json").json
    assert score["scenes"] == score["tables"] == 77
    assert score["plane_error_mm_median"] < 0.5 and score["plane_error_deg_median"] < 0.1
    assert score["alone"] == 152 and score["whole"] == 119 and score["objects"] == 329
    assert score["alone_found"] >= 148
    assert score["whole_found"] >= 118
    assert score["right"] >= 300
    assert score["f_os"] <= 0.02
    assert score["f_us"] <= 0.06
    assert score["over"] <= 9
    assert score["table_clusters"] == 0


def test_slabs_floor_and_wall_added_to_real_scenes():
    needs_mosd()
    program = os.environ.get("VOXID", os.environ.get("VOXID_BUILD", "build") + "/bin/voxid")
    answer = subprocess.run(["scripts/evaluate_additions", MOSD, "--voxid", program, "--only", "learn0",
                             "--only", "learn40"],
                            stdout=subprocess.PIPE, text=True, check=True)
    lines = {line.split(":")[0]: line for line in answer.stdout.splitlines()}
    assert "found 1.00, right 1.00" in lines["slab of  8 mm at 0.9 m"]
    assert "found 1.00" in lines["slab of 10 mm at 1.3 m"]
    assert "table found in 2 of 2" in answer.stdout


def test_things_on_rendered_tables(tmp_path):
    corners = [f"{x} {y} {z}" for z in (0, 1) for y in (0, 1) for x in (0, 1)]
    sides = ["0 1 3 2", "4 5 7 6", "0 1 5 4", "2 3 7 6", "0 2 6 4", "1 3 7 5"]
    (tmp_path / "cube").mkdir()
    (tmp_path / "cube" / "one.ply").write_text("\n".join(
        ["ply", "format ascii 1.0", "element vertex 8", "property float x", "property float y", "property float z",
         "element face 6", "property list uchar int vertex_indices", "end_header", *corners,
         *(f"4 {side}" for side in sides), ""]))
    program = os.environ.get("VOXID", os.environ.get("VOXID_BUILD", "build") + "/bin/voxid")
    evaluate = ["scripts/evaluate_tables", tmp_path, "--tables", "3", "--voxid", program]
    answer = subprocess.run(evaluate, stdout=subprocess.PIPE, text=True, check=True).stdout
    assert answer == "3 things on 3 tables: 3 right, 0 in parts, 0 partly found, 0 with others, 0 missed\n"
    blind = subprocess.run([*evaluate, "--list", "--set", "min_table_pixels=200000"], stdout=subprocess.PIPE, text=True,
                           check=True).stdout.splitlines()
    assert blind[0] == "table 1: cube/one missed"
    assert blind[-1].endswith("3 missed")
