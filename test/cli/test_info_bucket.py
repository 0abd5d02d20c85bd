# SPDX-License-Identifier: BSD-3-Clause
import re

import cv2
import pytest


@pytest.fixture(scope="module", params=["index", "paper_index"])
def index(request):
    return request.getfixturevalue(request.param)


@pytest.fixture(scope="module")
def bucket(voxid, index):
    """Of the first views, the largest bucket."""
    buckets = [voxid("info", index, "--bucket", f"view:{view}", "--json").json for view in range(0, 560, 40)]
    for view, found in zip(range(0, 560, 40), buckets):
        assert view in [entry["view"] for entry in found["views"]]
    return max(buckets, key=lambda found: len(found["views"]))


def test_a_bucket_is_found_by_its_key_and_by_each_of_its_views(voxid, index, bucket):
    assert len(bucket["views"]) > 1
    assert re.fullmatch("0x[0-9a-f]{13}", bucket["key"]) and bin(int(bucket["key"], 16)).count("1") <= 6
    numbers = [entry["view"] for entry in bucket["views"]]
    assert numbers == sorted(set(numbers))
    for wanted in (bucket["key"], bucket["key"].replace("0x", "0x000"), f"view:{numbers[0]}", f"view:{numbers[-1]}"):
        assert voxid("info", index, "--bucket", wanted, "--json").json == bucket


def test_views_are_named_as_the_index_orders_them(bucket):
    """Seven models of 80 views each: by category, then model, then direction."""
    models = ["ball/ball_a", "board/board_a", "cone/cone_a", "cube/cube_a", "cube/cube_b", "rod/rod_a", "tin/tin_a"]
    for entry in bucket["views"]:
        assert (entry["model"], entry["direction"]) == (models[entry["view"] // 80], entry["view"] % 80)


def test_the_list(voxid, index, bucket):
    answer = voxid("info", index, "--bucket", bucket["key"])
    assert answer.code == 0
    first, *views = answer.out.splitlines()
    assert first == f"key {bucket['key']}: {len(bucket['views'])} views"
    assert [line.split() for line in views] == [[str(e["view"]), "direction", str(e["direction"]), e["model"]]
                                                for e in bucket["views"]]


def test_the_picture_shows_every_view(voxid, index, models, bucket, tmp_path):
    answer = voxid("info", index, "--bucket", bucket["key"], "--plot", tmp_path / "b.png", "--models", models)
    assert (answer.code, answer.err) == (0, "")
    picture = cv2.imread(str(tmp_path / "b.png"))
    drawn = min(len(bucket["views"]), 48)
    columns = min(max(drawn, 2), 8)
    assert picture.shape == (22 + -(-drawn // columns) * 172, columns * 150, 3)
    for i in range(drawn):
        x, y = i % columns * 150, 22 + i // columns * 172
        assert (picture[y:y + 150, x:x + 150] < 240).mean() > 0.02, f"thumbnail {i} shows an object"


def test_bad_use(voxid, index, models, tmp_path):
    voxid("info", index, "--bucket", "mug").refuses(2, "mug", "view:N")
    voxid("info", index, "--bucket", "view:x").refuses(2, "view:x")
    voxid("info", index, "--bucket", "view:-1").refuses(2, "view:-1")
    voxid("info", index, "--bucket", "view:560").refuses(2, "560")
    voxid("info", index, "--bucket", "0xfffffffffffff").refuses(3, "0xfffffffffffff")
    voxid("info", index, "--bucket", "view:0", "--plot", tmp_path / "b.png").refuses(2, "--models")
    voxid("info", index, "--plot", tmp_path / "b.png").refuses(2, "--bucket")
    plot = ("info", index, "--bucket", "view:0", "--plot")
    voxid(*plot, tmp_path / "b.png", "--models", tmp_path).refuses(1, "ball/ball_a")
    voxid(*plot, tmp_path / "no" / "b.png", "--models", models).refuses(1, "b.png")
