# SPDX-License-Identifier: BSD-3-Clause
import pytest

import solids


@pytest.fixture(scope="module")
def unseen(tmp_path_factory):
    folder = tmp_path_factory.mktemp("unseen")
    solids.write_ply(folder / "tin" / "tin_u.ply", solids.turned([(0.0, 0.0), (0.45, 0.0), (0.45, 1.0), (0.0, 1.0)]))
    solids.write_ply(folder / "cube" / "cube_u.ply", solids.box(1.0, 0.95, 0.9))
    return folder


@pytest.fixture(scope="module")
def result(voxid, index, models, unseen):
    return voxid("eval", "--index", index, "--poses", "--models", models, "--unseen", unseen, "--objects", 12,
                 "--json").json


def test_members_are_found_where_they_are(result):
    seen = result["seen"]
    assert seen["objects"] == 12
    assert seen["strict_given_model"] >= 0.75  # cubes, tins and balls show faces that many poses explain
    assert seen["strict"] <= seen["model_right"] <= 1
    assert 0 <= seen["translation_mm_median"] < 5 and 0 <= seen["scale_percent_median"] < 3
    assert seen["ms_given_model_median"] > 0 and seen["ms_median"] > 0


def test_strangers_have_the_size_of_what_they_look_like(result):
    assert result["unseen"]["objects"] == 12
    assert result["unseen"]["extents_within_share"] >= 0.5
    assert result["unseen"]["ms_median"] > 0


def test_the_same_views_every_time(voxid, index, models, unseen, result):
    again = voxid("eval", "--index", index, "--poses", "--models", models, "--unseen", unseen, "--objects", 12,
                  "--json").json
    for part in ("seen", "unseen"):
        assert {k: v for k, v in again[part].items() if "ms" not in k.split("_")} == \
               {k: v for k, v in result[part].items() if "ms" not in k.split("_")}


def test_pcl_is_asked_about_each_nth_of_the_same_views_whatever_the_jobs(voxid, index, models, unseen, result):
    ask = ["eval", "--index", index, "--poses", "--models", models, "--unseen", unseen, "--objects", 12, "--json"]
    compared = voxid(*ask, "--compare", "--every", 4, "--jobs", 2).json
    for part in ("seen", "unseen"):
        assert {k: v for k, v in compared[part].items() if "ms" not in k.split("_")} == \
               {k: v for k, v in result[part].items() if "ms" not in k.split("_")}
    pcl = compared["pcl"]
    assert pcl["pairs"] == 3  # numbers 0, 4, 8
    assert 0 <= pcl["strict_given_model"] <= 1 and pcl["voxid_strict_given_model"] >= 1 / 3
    assert pcl["times_slower"] == pytest.approx(pcl["ms_median"] / pcl["voxid_ms_median"], rel=0.02)
    again = voxid(*ask, "--compare", "--every", 4).json["pcl"]
    assert again["strict_given_model"] == pcl["strict_given_model"]


def test_for_people(voxid, index, models, unseen):
    answer = voxid("eval", "--index", index, "--poses", "--models", models, "--unseen", unseen, "--objects", 1)
    assert answer.code == 0, answer.err
    assert "1 view of members" in answer.out and "box diagonal within 10 %" in answer.out


def test_what_cannot_be(voxid, index, models, unseen, tmp_path):
    voxid("eval", "--index", index, "--poses", "--models", models).refuses(2, "--unseen")
    voxid("eval", "--index", index, "--poses", "--models", models, "--unseen", tmp_path / "none").refuses(1, "none")
    answer = voxid("eval", "--index", index, "--poses", "--models", tmp_path, "--unseen", unseen)
    answer.refuses(1, "no mesh of this name", "made from")
