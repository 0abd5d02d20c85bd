# SPDX-License-Identifier: BSD-3-Clause
import os
import shutil

import numpy as np
import pytest

import solids

DESCRIPTORS = ["paper", "d2", "esf"]


@pytest.fixture(scope="module")
def unseen(tmp_path_factory):
    """Four models whose categories the library has, and one whose category it lacks."""
    folder = tmp_path_factory.mktemp("unseen")
    solids.write_ply(folder / "ball" / "ball_u.ply", solids.ball(rings=12))
    solids.write_ply(folder / "board" / "board_u.ply", solids.box(1.0, 0.7, 0.05))
    solids.write_ply(folder / "cube" / "cube_u.ply", solids.box(1.0, 0.95, 0.9))
    solids.write_ply(folder / "rod" / "rod_u.ply", solids.box(1.0, 0.95, 0.85))  # a cube under a wrong name
    solids.write_ply(folder / "moon" / "moon_u.ply", solids.ball())
    return folder


@pytest.fixture(scope="module")
def result(voxid, models, unseen):
    return voxid("eval", "--retrieval", "--models", models, "--unseen", unseen, "--json").json


def scores(right):
    """nn, first tier, second tier, average precision of a ranking, by their definitions."""
    c = sum(right)
    precisions = [sum(right[:i + 1]) / (i + 1) for i, hit in enumerate(right) if hit]
    return right[0], sum(right[:c]) / c, sum(right[:2 * c]) / c, sum(precisions) / c


def described(voxid, folder):
    paths = sorted(folder.glob("*/*.ply"))
    return [(path.parent.name, np.array(voxid("describe", path, "--pairs", 60000, "--json").json["bins"], int))
            for path in paths]


def test_what_is_counted(result):
    assert (result["models"], result["queries"], result["left_out"], result["skipped"]) == (7, 4, 1, [])
    assert [row["descriptor"] for row in result["rows"]] == DESCRIPTORS
    for row in result["rows"]:
        assert 0 <= row["nn"] <= 100 and 0 <= row["tier1"] <= row["tier2"] <= 100 and 0 < row["map"] <= 100


def test_differences_are_those_of_the_rows(result):
    *ours, esf = result["rows"]
    assert esf["nn_minus_esf"] is None and esf["map_minus_esf_95"] is None
    for row in ours:
        for figure in ("nn", "map"):
            low, high = row[f"{figure}_minus_esf_95"]
            assert low <= row[f"{figure}_minus_esf"] <= high
            assert row[f"{figure}_minus_esf"] == pytest.approx(row[figure] - esf[figure], abs=0.02)


def without_esf(result):
    """Rows without the row of ESF, which differs from second to second, and without what is counted from it."""
    return [{k: v for k, v in row.items() if "esf" not in k} for row in result["rows"][:2]]


def test_the_figures_follow_from_the_descriptors(voxid, models, unseen, result):
    """The paper's row, computed anew from what `describe` prints of each mesh."""
    library, each = described(voxid, models), []
    for category, bins in described(voxid, unseen):
        ranked = sorted(library, key=lambda other: np.abs(other[1] - bins).sum())
        right = [other == category for other, _ in ranked]
        if any(right):
            each.append(scores(right))
    nn, tier1, tier2, mean_ap = 100 * np.mean(each, axis=0)
    row = result["rows"][0]
    assert (row["nn"], row["tier1"], row["tier2"], row["map"]) == pytest.approx((nn, tier1, tier2, mean_ap), abs=0.01)
    assert nn == 75, "the cube that is called a rod is taken for a cube"


def test_every_descriptor_finds_a_model_among_copies(voxid, models):
    rows = voxid("eval", "--retrieval", "--models", models, "--unseen", models, "--json").json["rows"]
    for row in rows:
        if row["descriptor"] != "esf":  # it differs from second to second
            assert row["nn"] == 100 and row["map"] > 90


def test_it_does_not_depend_on_jobs_or_repetition(voxid, models, unseen, result):
    other = voxid("eval", "--retrieval", "--models", models, "--unseen", unseen, "--json", "--jobs", 2).json
    assert without_esf(other) == without_esf(result)


def test_the_index_may_say_how_to_describe(voxid, index, models, unseen, result):
    """The index was made with 10,000 lines, not 60,000."""
    other = voxid("eval", "--retrieval", "--index", index, "--models", models, "--unseen", unseen, "--json").json
    assert (result["pairs"], other["pairs"]) == (60000, 10000)
    assert other["rows"][0]["map"] == pytest.approx(result["rows"][0]["map"], abs=10)


def test_the_table(voxid, models, unseen):
    answer = voxid("eval", "--retrieval", "--models", models, "--unseen", unseen)
    assert (answer.code, answer.err) == (0, "")
    assert "4 whole models" in answer.out and "1 left out" in answer.out
    assert [line.split()[0] for line in answer.out.splitlines()[-3:]] == DESCRIPTORS


def test_unreadable_models_are_skipped_and_named(voxid, models, unseen, result, tmp_path):
    folder = tmp_path / "unseen"
    shutil.copytree(unseen, folder)
    (folder / "cube" / "broken.ply").write_text("ply\nno more\n")
    (folder / "cube" / "cube_u.stl").write_text("solid nothing\n")
    other = voxid("eval", "--retrieval", "--models", models, "--unseen", folder, "--json").json
    broken, twin = other["skipped"]
    assert broken["model"] == os.path.join(str(folder), "cube", "broken.ply") and broken["reason"]
    assert twin["model"].endswith("cube_u.stl") and "same name" in twin["reason"]
    assert other["queries"] == 4 and without_esf(other) == without_esf(result)


def test_bad_use(voxid, index, models, unseen, tmp_path):
    voxid("eval", "--retrieval", "--models", models).refuses(2, "--unseen")
    voxid("eval", "--retrieval", "--unseen", unseen).refuses(2, "--models")
    voxid("eval", "--index", index, "--unseen", unseen, "--queries", ".").refuses(2, "--retrieval")
    voxid("eval", "--retrieval", "--models", models, "--unseen", unseen, "--queries", ".").refuses(2, "--queries")
    voxid("eval", "--queries", ".").refuses(2, "--index")
    voxid("eval", "--retrieval", "--models", tmp_path / "none", "--unseen", unseen).refuses(1, "none")
    voxid("eval", "--retrieval", "--models", models, "--unseen", tmp_path).refuses(3, tmp_path)
    moons = tmp_path / "moons"
    shutil.copytree(unseen / "moon", moons / "moon")
    voxid("eval", "--retrieval", "--models", models, "--unseen", moons).refuses(3, "no model of it")
