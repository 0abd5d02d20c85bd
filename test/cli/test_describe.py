# SPDX-License-Identifier: BSD-3-Clause
import cv2
import numpy as np
import pytest

import solids

BINS = {"D2 coarse": 32, "D2 fine": 128, "ON": 64, "OFF": 64, "MIXED": 64, "ratio": 64}


def write_xyz(path, points):
    path.write_text("".join(f"{x:.6f} {y:.6f} {z:.6f}\n" for x, y, z in points))
    return path


def write_pcd(path, points, binary=False):
    points = np.asarray(points, np.float32).reshape(-1, 3)
    header = ("# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z\n"
              "SIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n"
              f"WIDTH {len(points)}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {len(points)}\n"
              f"DATA {'binary' if binary else 'ascii'}\n")
    body = points.tobytes() if binary else "".join("{:.6f} {:.6f} {:.6f}\n".format(*p) for p in points).encode()
    path.write_bytes(header.encode() + body)
    return path


@pytest.fixture(scope="module")
def cap():
    """Half a ball, 1,000 points, micrometre-exact."""
    i = np.arange(1000)
    z, angle = i / 1000, i * 2.399963
    r = np.sqrt(1 - z * z)
    return np.round(np.stack([r * np.cos(angle), r * np.sin(angle), z + 5], 1) * 0.1, 6)


def test_the_fields(voxid, depth_file, slab):
    path = depth_file("slab.png", slab)
    line = voxid("describe", path, "--json").json
    assert (line["file"], line["status"], line["points"], line["descriptor"]) == (str(path), "ok", 8000, "paper")
    assert {name: len(bins) for name, bins in line["histograms"].items()} == BINS
    assert line["bins"] == [b for bins in line["histograms"].values() for b in bins] and len(line["bins"]) == 416
    assert all(0 <= b <= 255 for b in line["bins"])
    key = int(line["key"], 16)
    assert line["key"].startswith("0x") and 0 < key < 2**52 and bin(key).count("1") <= 6
    assert max(line["histograms"]["ON"]) > 0, "lines inside a plate run on its surface"


def test_the_key_marks_each_highest_bin(voxid, depth_file, slab):
    line = voxid("describe", depth_file("slab.png", slab), "--json").json
    expected, first = 0, 0
    for bins in line["histograms"].values():
        if max(bins):
            expected |= 1 << (first + bins.index(max(bins))) // 8
        first += len(bins)
    assert int(line["key"], 16) == expected


def test_points_are_the_same_in_every_file_format(voxid, tmp_path, cap):
    answers = [voxid("describe", path, "--json").json for path in (
        write_xyz(tmp_path / "a.xyz", cap), write_pcd(tmp_path / "b.pcd", cap),
        write_pcd(tmp_path / "C.PCD", cap, binary=True))]
    assert [a["points"] for a in answers] == [1000] * 3
    # float32 metres of a PCD file are as good as micrometres at half a metre
    assert answers[0]["bins"] == answers[1]["bins"] == answers[2]["bins"]


def test_moved_points_have_the_same_descriptor(voxid, tmp_path, cap):
    here = voxid("describe", write_xyz(tmp_path / "a.xyz", cap), "--json").json
    there = voxid("describe", write_xyz(tmp_path / "b.xyz", cap + [0.25, -1.5, 3.0]), "--json").json
    assert here["bins"] == there["bins"]


def test_seed_and_pairs_matter_and_repeat(voxid, tmp_path, cap):
    path = write_xyz(tmp_path / "a.xyz", cap)
    plain = voxid("describe", path, "--json").json
    assert voxid("describe", path, "--json").json == plain
    assert voxid("describe", path, "--json", "--seed", 2).json["bins"] != plain["bins"]
    assert voxid("describe", path, "--json", "--pairs", 500).json["pairs"] == 500


@pytest.mark.parametrize("points, status",
                         [([], "empty"), ([(0, 0, 1)], "degenerate"), ([(0.1, 0.2, 1)] * 9, "degenerate"),
                          ([(float("nan"), 0, 1)] * 5, "empty"), ([(float("inf"), 0, 1), (0, 0, 1)], "degenerate"),
                          ([(9e9, 0, 1), (0, 0, 1)], "degenerate")])
@pytest.mark.parametrize("write", [write_xyz, write_pcd])
def test_too_few_points_are_said(voxid, tmp_path, write, points, status):
    path = write(tmp_path / ("few.xyz" if write is write_xyz else "few.pcd"), points)
    answer = voxid("describe", path, "--json")
    answer.refuses(3, path.name, "at least two")
    (line,) = answer.lines
    assert line["status"] == status and set(line["bins"]) == {0} and int(line["key"], 16) == 0


@pytest.mark.parametrize("points", [[(0, 0, 1), (0.1, 0, 1)], [(0, 0, 1), (0.1, 0, 1), (0, 0.1, 1)],
                                    [(0, 0, 1), (float("nan"), 0, 1), (0.1, 0, 1)]])
def test_two_points_are_enough(voxid, tmp_path, points):
    line = voxid("describe", write_xyz(tmp_path / "few.xyz", points), "--json").json
    assert line["status"] == "ok" and sum(line["bins"]) > 0
    assert line["points"] == sum(p[0] == p[0] for p in points)


def test_lines_planes_limits_and_a_million_points_are_described(voxid, tmp_path):
    i = np.arange(400)
    far = 2147.0  # metres; micrometres in 32 bits end 0.48 m farther
    clouds = {"line": np.stack([i, 2 * i, 3 * i], 1) * 1e-3,
              "plane": np.stack([i % 20, i // 20, 0 * i], 1) * 1e-2,
              "limits": [(-far, -far, -far), (far, far, far), (far, -far, 0)]}
    for name, points in clouds.items():
        line = voxid("describe", write_xyz(tmp_path / f"{name}.xyz", points), "--json").json
        assert line["status"] == "ok" and line["points"] == len(points), name
    points = np.random.default_rng(1).uniform(0, 0.2, (1000000, 3))
    line = voxid("describe", write_pcd(tmp_path / "many.pcd", points, binary=True), "--json").json
    assert line["status"] == "ok" and sum(line["bins"]) > 0


def test_empty_image_and_one_pixel(voxid, depth_file):
    pixels = np.zeros((480, 640), np.uint16)
    voxid("describe", depth_file("none.png", pixels)).refuses(3, "no point")
    pixels[1, 1] = 1000
    voxid("describe", depth_file("one.png", pixels)).refuses(3, "1 point")
    voxid("describe", depth_file("nan.tiff", np.full((480, 640), np.nan, np.float32))).refuses(3, "no point")


def test_damaged_point_files(voxid, tmp_path, cap):
    voxid("describe", tmp_path / "none.pcd").refuses(1, "no such file")
    (tmp_path / "empty.pcd").touch()
    voxid("describe", tmp_path / "empty.pcd").refuses(4, "empty")
    (tmp_path / "text.pcd").write_text("no cloud\n")
    voxid("describe", tmp_path / "text.pcd").refuses(4, "damaged PCD")
    whole = write_pcd(tmp_path / "whole.pcd", cap, binary=True).read_bytes()
    for length in [20, 100, len(whole) // 2, len(whole) - 1]:
        (tmp_path / "cut.pcd").write_bytes(whole[:length])
        voxid("describe", tmp_path / "cut.pcd").refuses(4, "cut.pcd")
    huge = whole.replace(b"WIDTH 1000", b"WIDTH 2000000000").replace(b"POINTS 1000", b"POINTS 2000000000")
    (tmp_path / "huge.pcd").write_bytes(huge)
    voxid("describe", tmp_path / "huge.pcd").refuses(4, "huge.pcd")
    (tmp_path / "flat.pcd").write_bytes(whole.replace(b"FIELDS x y z", b"FIELDS x y w"))
    voxid("describe", tmp_path / "flat.pcd").refuses(1, "field z")
    (tmp_path / "odd.xyz").write_text("0 0 1\n0 0 two\n")
    voxid("describe", tmp_path / "odd.xyz").refuses(4, "line 2")


def test_the_plot_shows_six_panels(voxid, depth_file, slab, tmp_path):
    assert voxid("describe", depth_file("slab.png", slab), "--plot", tmp_path / "d.png").code == 0
    picture = cv2.imread(str(tmp_path / "d.png"))
    assert picture.shape == (440, 1080, 3)
    panels = [picture[y:y + 220, x:x + 360] for y in (0, 220) for x in (0, 360, 720)]
    assert all((panel < 250).any() for panel in panels)


def test_a_mesh_is_described_as_a_whole(voxid, models):
    ball = voxid("describe", models / "ball" / "ball_a.ply", "--json").json
    assert (ball["status"], ball["points"]) == ("ok", 16384)
    assert voxid("describe", models / "ball" / "ball_a.ply", "--json").json == ball
    # Every point is a radius R from the centroid, two of them never farther apart than 2 R of the 3.4 R that a
    # histogram covers, and the density of their distances grows up to that.
    coarse = ball["histograms"]["D2 coarse"]
    assert coarse.index(max(coarse)) in (17, 18) and not any(coarse[20:])
    assert max(ball["histograms"]["OFF"]) > max(ball["histograms"]["ON"]), "lines cross the hollow"


def test_a_mesh_counts_by_area_not_by_triangles(voxid, tmp_path):
    """The same box, one side of it cut into many triangles."""
    corners, triangles = solids.box(1.0, 0.8, 0.6)
    solids.write_ply(tmp_path / "plain.ply", (corners, triangles))
    a, b, c = triangles.pop(0)
    n = 24
    corners = corners + [tuple(corners[a][k] + (corners[b][k] - corners[a][k]) * i / n for k in range(3))
                         for i in range(n + 1)]
    triangles += [(8 + i, 8 + i + 1, c) for i in range(n)]
    solids.write_ply(tmp_path / "cut.ply", (corners, triangles))
    plain, cut = (np.array(voxid("describe", tmp_path / f"{name}.ply", "--json").json["bins"])
                  for name in ("plain", "cut"))
    assert np.abs(plain - cut).sum() < 1500 < np.abs(plain - voxid_bins_of_ball(voxid, tmp_path)).sum()


def voxid_bins_of_ball(voxid, folder):
    solids.write_ply(folder / "ball.ply", solids.ball())
    return np.array(voxid("describe", folder / "ball.ply", "--json").json["bins"])


def test_a_mesh_that_cannot_be_read(voxid, tmp_path):
    (tmp_path / "cut.ply").write_text("ply\nformat ascii 1.0\n")
    answer = voxid("describe", tmp_path / "cut.ply")
    answer.refuses(answer.code, "cut.ply")
    assert answer.code in (1, 4)
    voxid("describe", tmp_path / "none.obj").refuses(1, "none.obj")


def shows(panel, blue, green, red):
    """Pixels of about this colour."""
    return (np.abs(panel.astype(int) - (blue, green, red)).max(axis=2) < 40).sum()


GREEN, RED, BLUE = (60, 150, 30), (40, 30, 210), (200, 90, 30)


def line_panels(path):
    picture = cv2.imread(str(path))
    assert picture.shape == (960, 960, 3)
    return [picture[y:y + 480, x:x + 480] for y in (0, 480) for x in (0, 480)]


def test_lines_have_a_panel_a_kind(voxid, models, tmp_path):
    assert voxid("describe", models / "ball" / "ball_a.ply", "--plot-lines", tmp_path / "l.png").code == 0
    grid, *kinds = line_panels(tmp_path / "l.png")
    assert (grid < 230).any(axis=2).sum() > 480 * 480 / 4, "the grid fills its panel"
    for panel, colour in zip(kinds, (GREEN, RED, BLUE)):
        for other in (GREEN, RED, BLUE):
            assert (shows(panel, *other) > 100) == (other == colour)


def test_no_line_leaves_a_plate(voxid, depth_file, slab, tmp_path):
    assert voxid("describe", depth_file("slab.png", slab), "--plot-lines", tmp_path / "l.png").code == 0
    _, on, off, _ = line_panels(tmp_path / "l.png")
    assert shows(on, *GREEN) > 100 and shows(off, *RED) == 0


@pytest.mark.parametrize("points", [[(0, 0, 1), (0.1, 0, 1)], [(0, 0, 1 + i / 1000) for i in range(100)]])
def test_lines_of_a_line(voxid, tmp_path, points):
    answer = voxid("describe", write_xyz(tmp_path / "few.xyz", points), "--plot-lines", tmp_path / "l.png")
    assert answer.code == 0 and len(line_panels(tmp_path / "l.png")) == 4


def test_one_point_has_no_lines(voxid, tmp_path):
    answer = voxid("describe", write_xyz(tmp_path / "one.xyz", [(0, 0, 1)]), "--plot-lines", tmp_path / "l.png")
    answer.refuses(3, "at least two")
    assert not (tmp_path / "l.png").exists()


def test_the_nearest_view_is_the_one_that_classify_finds(voxid, paper_index, views, tmp_path):
    image = views("tin", "tin_a", 17)
    line = voxid("describe", image, "--index", paper_index, "--plot", tmp_path / "d.png", "--json").json
    answer = voxid("classify", image, "--index", paper_index, "--1nn", "--json").json
    assert line["match"]["model"] == f"{answer['label']}/{answer['model']}"
    assert line["match"]["direction"] == answer["view"]
    assert line["match"]["distance"] == answer["alternatives"][0]["distance"]
    usual = voxid("describe", image, "--json").json["bins"]
    assert line["bins"] == usual, "an index's lines and seed are the usual ones"
    assert f"nearest: {line['match']['model']}, direction" in voxid("describe", image, "--index", paper_index).out
    picture = cv2.imread(str(tmp_path / "d.png"))
    assert picture.shape == (468, 1080, 3)
    panels = [picture[y:y + 220, x:x + 360] for y in (28, 248) for x in (0, 360, 720)]
    assert all(shows(panel, 80, 180, 70) > 100 and shows(panel, *RED) > 100 for panel in panels[:2])


def test_a_match_needs_two_points_and_the_lines_of_its_index(voxid, index, paper_index, depth_file, slab):
    image = depth_file("slab.png", slab)
    voxid("describe", image, "--index", index).refuses(1, index.name, "--descriptor paper")
    voxid("describe", image, "--index", paper_index, "--pairs", 500).refuses(2, "--index", "--pairs")
    voxid("describe", image, "--index", image).refuses(4, image.name)
    voxid("describe", depth_file("none.png", slab * 0), "--index", paper_index).refuses(3, "no point")
