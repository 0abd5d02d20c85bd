# SPDX-License-Identifier: BSD-3-Clause
import cv2
import numpy as np
import pytest

TAUGHT = ["ball", "board", "cone", "cube", "rod", "tin"]


@pytest.mark.parametrize("category, model, direction",
                         [("tin", "tin_a", 17), ("cone", "cone_a", 3), ("board", "board_a", 64)])
def test_a_taught_view_is_found_again(voxid, index, views, category, model, direction):
    image = views(category, model, direction)
    answer = voxid("classify", image, "--index", index, "--1nn", "--json").json
    assert (answer["file"], answer["label"], answer["model"]) == (str(image), category, model)
    assert isinstance(answer["view"], int) and 0 <= answer["view"] < 80
    assert answer["pixels"] == np.count_nonzero(cv2.imread(str(image), cv2.IMREAD_UNCHANGED))


@pytest.mark.parametrize("options", [[], ["--vote"], ["--1nn"], ["--exact"], ["--lists", 4], ["--lists", 1, "--1nn"]])
def test_alternatives_are_ranked_and_at_least_five(voxid, index, views, options):
    ranked_and_at_least_five(voxid, index, views, options, 96 * 240**2)


@pytest.mark.parametrize("options", [[], ["--radius", 4], ["--radius", 0, "--1nn"]])
def test_the_papers_alternatives_are_ranked_and_at_least_five(voxid, paper_index, views, options):
    ranked_and_at_least_five(voxid, paper_index, views, options, 416 * 255)


def ranked_and_at_least_five(voxid, index, views, options, farthest):
    answer = voxid("classify", views("rod", "rod_a", 5), "--index", index, "--json", *options).json
    alternatives = answer["alternatives"]
    labels = [a["label"] for a in alternatives]
    assert labels[0] == answer["label"] == "rod"
    assert len(set(labels)) == len(labels) >= 5 and set(labels) <= set(TAUGHT)
    scores = [a["score"] for a in alternatives]
    assert scores == sorted(scores, reverse=True) and 0 <= min(scores) and sum(scores) <= 1.0005
    assert scores[0] == answer["score"]
    assert all(isinstance(a["distance"], int) and 0 <= a["distance"] <= farthest for a in alternatives)
    if "--1nn" in options:
        distances = [a["distance"] for a in alternatives]
        assert distances == sorted(distances)


def test_quick_search_among_everything_is_exact(voxid, index, paper_index, views):
    image = views("cube", "cube_b", 9)
    for file, everything in [(paper_index, ["--radius", 52]), (index, ["--lists", 65536])]:
        exact = voxid("classify", image, "--index", file, "--json", "--exact").json
        found = voxid("classify", image, "--index", file, "--json", *everything).json
        assert found["alternatives"][:3] == exact["alternatives"][:3] and found["label"] == exact["label"]


def test_a_search_of_the_other_descriptor_is_refused(voxid, index, paper_index, views):
    image = views("cube", "cube_b", 9)
    voxid("classify", image, "--index", index, "--radius", 4).refuses(2, "--radius", "--lists")
    voxid("classify", image, "--index", paper_index, "--lists", 4).refuses(2, "--lists", "--radius")
    voxid("classify", image, "--index", index, "--lists", 4, "--radius", 4).refuses(2, "--lists", "--radius")


@pytest.mark.parametrize("options", [[], ["--lists", 1], ["--1nn"], ["--evidence", "size"]])
def test_only_listed_categories_are_answers(voxid, index, views, tmp_path, options):
    listed = tmp_path / "listed.txt"
    listed.write_text("ball\nrod\ntin\nnot_taught\n")
    ask = ["classify", views("cube", "cube_b", 9), "--index", index, "--json", *options]
    assert voxid(*ask).json["label"] == "cube"
    among = voxid(*ask, "--categories", listed).json
    assert {a["label"] for a in among["alternatives"]} == {"ball", "rod", "tin"}
    assert among["label"] in {"ball", "rod", "tin"}


def test_a_list_of_no_taught_category_is_refused(voxid, index, views, tmp_path):
    ask = ["classify", views("cube", "cube_b", 9), "--index", index, "--categories"]
    voxid(*ask, tmp_path / "none.txt").refuses(1, "none.txt")
    (tmp_path / "other.txt").write_text("anything\n")
    voxid(*ask, tmp_path / "other.txt").refuses(1, "other.txt")


def test_several_files_give_a_line_each_in_their_order(voxid, index, views):
    images = [views("tin", "tin_a", 17), views("ball", "ball_a", 0), views("cone", "cone_a", 3)]
    answer = voxid("classify", *images, "--index", index, "--json")
    assert answer.code == 0
    assert [line["file"] for line in answer.lines] == list(map(str, images))
    single = [voxid("classify", image, "--index", index, "--json").json for image in images]
    assert answer.lines == single


def test_below_the_least_score_the_label_is_empty(voxid, index, views):
    image = views("ball", "ball_a", 0)
    told = voxid("classify", image, "--index", index, "--json").json
    hidden = voxid("classify", image, "--index", index, "--json", "--min-score", 1).json
    assert told["score"] < 1, "the built-in calibration promises nothing"
    assert hidden["label"] == "" and hidden["alternatives"] == told["alternatives"] and hidden["model"] == told["model"]


def test_the_table_names_file_label_and_model(voxid, index, views):
    image = views("tin", "tin_a", 17)
    answer = voxid("classify", image, "--index", index)
    assert answer.code == 0
    (row,) = answer.out.splitlines()
    assert str(image) in row and "tin_a" in row


def test_float_metres_are_the_same_as_millimetres(voxid, index, depth_file, slab):
    millimetres = voxid("classify", depth_file("a.png", slab), "--index", index, "--json").json
    metres = voxid("classify", depth_file("b.tiff", (slab / 1000).astype(np.float32)), "--index", index, "--json").json
    assert {**metres, "file": ""} == {**millimetres, "file": ""}


@pytest.mark.parametrize("points", [0, 1])
def test_nothing_to_classify_still_gives_its_line(voxid, index, depth_file, points):
    pixels = np.zeros((480, 640), np.uint16)
    pixels[240, 320:320 + points] = 900
    answer = voxid("classify", depth_file("few.png", pixels), "--index", index, "--json")
    answer.refuses(3, "few.png", "nothing to classify")
    (line,) = answer.lines
    assert (line["label"], line["score"], line["alternatives"], line["model"], line["view"]) == ("", 0, [], "", None)


@pytest.mark.parametrize("points", [2, 3])
def test_two_points_are_enough_for_an_answer(voxid, index, depth_file, points):
    pixels = np.zeros((480, 640), np.uint16)
    pixels[240, 320:320 + 20 * points:20] = 900
    line = voxid("classify", depth_file("few.png", pixels), "--index", index, "--json").json
    assert line["pixels"] == points and len(line["alternatives"]) >= 5


def test_one_result_among_several_files_is_enough(voxid, index, views, depth_file):
    empty = depth_file("empty.png", np.zeros((480, 640), np.uint16))
    answer = voxid("classify", empty, views("tin", "tin_a", 17), "--index", index, "--json")
    assert answer.code == 0 and [bool(line["label"]) for line in answer.lines] == [False, True]


def test_plots_are_pictures(voxid, index, views, scene, tmp_path):
    images = [views("tin", "tin_a", 17), views("ball", "ball_a", 0)]
    assert voxid("classify", *images, "--index", index, "--plot", tmp_path / "a.png").code == 0
    drawn = sorted(tmp_path.glob("a-*.png"))
    assert len(drawn) == 2 and all(cv2.imread(str(p)).shape == (480, 640, 3) for p in drawn)
    voxid("classify", scene, "--scene", "--index", index, "--plot", tmp_path / "s.png")
    assert cv2.imread(str(tmp_path / "s.png")).shape == (480, 640, 3)
    voxid("classify", images[0], "--index", index, "--plot", tmp_path / "no" / "a.png").refuses(1, "no/a.png")


def test_nothing_is_written_over_a_frame(voxid, index, scene):
    frame = scene.read_bytes()
    classify = ("classify", scene, "--index", index)
    voxid(*classify, "--scene", "--labels", scene.parent).refuses(2, scene)
    voxid(*classify, "--plot", scene).refuses(2, scene)
    assert scene.read_bytes() == frame


def test_a_scene_is_a_table_with_named_objects(voxid, index, scene, tmp_path):
    line = voxid("classify", scene, "--scene", "--index", index, "--json", "--labels", tmp_path / "labels").json
    assert line["file"] == str(scene) and line["status"] == "OK"
    table = line["table"]
    assert np.linalg.norm(table["normal"]) == pytest.approx(1, abs=1e-4) and table["normal"][1] < 0
    assert table["distance_m"] > 0.2 and len(table["outline"]) >= 3
    objects = line["objects"]
    assert [o["id"] for o in objects] == [1, 2]
    labels = cv2.imread(str(tmp_path / "labels" / (scene.stem + ".png")), cv2.IMREAD_UNCHANGED)
    assert labels.dtype == np.uint16 and set(np.unique(labels)) == {0, 1, 2}
    for o in objects:
        mask = labels == o["id"]
        rows, columns = np.nonzero(mask)
        x, y, width, height = o["box_px"]
        assert o["pixels"] == mask.sum()
        assert (x, y, x + width - 1, y + height - 1) == (columns.min(), rows.min(), columns.max(), rows.max())
        assert len(o["centroid_m"]) == 3 and all(0.03 < e < 0.25 for e in o["extents_m"])
        assert len(o["alternatives"]) >= 5 and o["model"] and 0 <= o["view"] < 80
        assert o["label"] == o["alternatives"][0]["label"]


@pytest.mark.parametrize("kind, status", [("empty", "EMPTY_TABLE"), ("ball", "NO_TABLE"), ("dark", "NO_DEPTH")])
def test_a_scene_without_objects_says_why(voxid, index, depth_file, slab, kind, status):
    pixels = np.zeros((480, 640), np.uint16)
    if kind == "empty":  # a table half a metre below the camera
        v = np.arange(260, 480)
        pixels[260:480] = (500 * 525 / (v - 239.5)).astype(np.uint16)[:, None]
    if kind == "ball":
        pixels[200:260, 300:360] = slab[200:260, 300:360]
    answer = voxid("classify", depth_file("f.png", pixels), "--scene", "--index", index, "--json")
    answer.refuses(3, "f.png", status)
    (line,) = answer.lines
    assert line["status"] == status and line["objects"] == []
    assert (line["table"] is None) == (status != "EMPTY_TABLE")


def test_settings_reach_the_segmentation(voxid, index, scene):
    voxid("classify", scene, "--scene", "--index", index, "--set", "max_depth_mm=310").refuses(3, "NO_")
    answer = voxid("classify", scene, "--scene", "--index", index, "--set", "max_depth_mm=1")
    answer.refuses(2, "max_depth_mm", "300 to 10000")
    voxid("classify", scene, "--scene", "--index", index, "--set", "no_such=1").refuses(2, "no_such", "min_depth_mm")
    voxid("classify", scene, "--index", index, "--set", "max_depth_mm=900").refuses(2, "--scene")


def test_up_reaches_the_segmentation(voxid, index, depth_file):
    flat = depth_file("flat.png", np.full((480, 640), 1000, np.uint16))
    voxid("classify", flat, "--scene", "--index", index, "--up", "0,0,-1").refuses(3, "EMPTY_TABLE")
    voxid("classify", flat, "--scene", "--index", index, "--up", "0,-1,0").refuses(3, "NO_TABLE")
    voxid("classify", flat, "--scene", "--index", index, "--up", "up").refuses(2, "X,Y,Z")
    voxid("classify", flat, "--index", index, "--up", "0,0,-1").refuses(2, "--scene")
