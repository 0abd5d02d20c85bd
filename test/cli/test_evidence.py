# SPDX-License-Identifier: BSD-3-Clause
"""--evidence align of `eval` and `classify`, and `classify --align`."""
import cv2
import numpy as np
import pytest


def test_alignment_is_a_third_row_held_against_the_vote(voxid, index, models, queries):
    ask = ["eval", "--index", index, "--queries", queries, "--json"]
    rows = voxid(*ask, "--evidence", "align", "--models", models).json["rows"]
    assert [row["method"] for row in rows] == ["1nn", "vote", "align"]
    codes = {row["method"]: row["top1"] for row in voxid(*ask).json["rows"]}
    assert {row["method"]: row["top1"] for row in rows[:2]} == codes
    aligned = rows[2]
    assert aligned["top1"] >= 66  # five of six are taught
    assert aligned["minus_vote"] == pytest.approx(aligned["top1"] - codes["vote"], abs=0.02)
    assert aligned["minus_vote_95"][0] <= aligned["minus_vote"] <= aligned["minus_vote_95"][1]
    assert aligned["us_per_query"] > rows[1]["us_per_query"]


def test_models_stand_where_the_objects_are(voxid, index, models, scene, tmp_path):
    picture = tmp_path / "poses.png"
    frame = voxid("classify", scene, "--index", index, "--scene", "--evidence", "align", "--align", "--models", models,
                  "--json", "--plot", picture).json
    assert [thing["label"] for thing in sorted(frame["objects"], key=lambda thing: thing["label"])] == ["cube", "tin"]
    for thing in frame["objects"]:
        pose = thing["pose"]
        assert pose["model"].startswith(thing["label"] + "/")
        centre_mm = 1000 * np.array(thing["centroid_m"])
        assert np.linalg.norm(np.array(pose["translation_mm"]) - centre_mm) < 80
        assert 120 < pose["scale_mm"] < 240 and pose["fit_mm"] < 4 and pose["explained"] > 0.8  # 12 cm long
        assert np.linalg.norm(pose["rotation"]) == pytest.approx(1, abs=1e-4)
        covariance = np.array(pose["covariance"]).reshape(7, 7)
        assert np.allclose(covariance, covariance.T, atol=1e-6) and np.all(np.diag(covariance) >= 0)
    without = tmp_path / "without.png"
    voxid("classify", scene, "--index", index, "--scene", "--plot", without)
    changed = np.any(cv2.imread(str(picture)) != cv2.imread(str(without)), axis=2)
    assert changed.sum() > 1000


@pytest.fixture(scope="module")
def kept(voxid, models, tmp_path_factory):
    """The index, with its models' surfaces."""
    path = tmp_path_factory.mktemp("kept") / "kept.vxi"
    assert voxid("build", "--models", models, "--out", path, "--jobs", 2, "--keep-points").code == 0
    return path


def test_an_index_that_keeps_surfaces_needs_no_models(voxid, index, kept, models, queries, scene):
    about, plain = (voxid("info", file, "--json").json for file in (kept, index))
    assert about["surfaces"] == about["models"] and about["surface_bytes"] > 0 and plain["surfaces"] == 0
    assert about["bytes_per_view"] == pytest.approx(plain["bytes_per_view"], abs=1)
    ask = ["classify", scene, "--scene", "--evidence", "align", "--align", "--json", "--index"]
    with_meshes, without = voxid(*ask, index, "--models", models).json, voxid(*ask, kept).json
    for known, thing in zip(with_meshes["objects"], without["objects"]):
        assert thing["label"] == known["label"] and thing["pose"]["model"] == known["pose"]["model"]
        assert thing["pose"]["translation_mm"] == pytest.approx(known["pose"]["translation_mm"], abs=2)
        assert thing["pose"]["scale_mm"] == pytest.approx(known["pose"]["scale_mm"], rel=0.02)
    rows = voxid("eval", "--index", kept, "--queries", queries, "--evidence", "align", "--json").json["rows"]
    assert rows[2]["method"] == "align" and rows[2]["top1"] >= 66


def test_what_cannot_be(voxid, index, models, queries, scene, tmp_path):
    voxid("eval", "--index", index, "--queries", queries, "--evidence", "align").refuses(2, "--models", "--keep-points")
    voxid("eval", "--index", index, "--evidence", "size").refuses(2, "--queries")
    voxid("classify", scene, "--index", index, "--evidence", "size,align").refuses(2, "--models")
    voxid("classify", scene, "--index", index, "--scene", "--align").refuses(2, "--models")
    answer = voxid("classify", scene, "--index", index, "--scene", "--align", "--models", tmp_path)
    answer.refuses(1, "no mesh of this name")
    voxid("classify", scene, "--index", index, "--vote", "--evidence", "align", "--models", models).refuses(2, "--vote")
