# SPDX-License-Identifier: BSD-3-Clause
"""voxid eval --unknown; what info tells about it."""
import pytest

# The learnt side is tested in test/library/confidence_learner_test.cpp: it takes more models than these.


def test_figures_are_shares_and_do_not_depend_on_jobs(voxid, index, queries, models, tmp_path):
    ask = ["eval", "--index", index, "--queries", queries, "--unknown", "--models", models, "--json"]
    result = voxid(*ask, "--plot", tmp_path / "plot.png").json
    assert result["queries"] == 6
    assert result["accuracy"] == pytest.approx(5 / 6, abs=1e-4)  # as test_eval_counts_right_answers
    for name in ("ece", "auc_wrong", "auc_left_out"):
        assert 0 <= result[name] <= 1
    assert list(result["coverage"]) == list(result["coverage_left_out"]) == ["5", "10", "20"]
    assert 0 <= result["coverage"]["5"] <= result["coverage"]["10"] <= result["coverage"]["20"] <= 1
    assert sum(fold["left_out"] for fold in result["folds"]) == 6
    said = [one["said"] for one in result["reliability"]]
    assert said == sorted(said) and sum(one["answers"] for one in result["reliability"]) == 6
    error = sum(abs(one["said"] - one["seen"]) * one["answers"] for one in result["reliability"]) / 6
    assert result["ece"] == pytest.approx(error, abs=1e-3)
    assert (tmp_path / "plot.png").stat().st_size > 1000
    assert voxid(*ask, "--jobs", 3).json == result


def test_table_for_people(voxid, index, queries):
    text = voxid("eval", "--index", index, "--queries", queries, "--unknown").out
    assert "6 queries, 83.3 % named rightly" in text and "left-out" in text


def test_bad_use(voxid, index, queries, tmp_path):
    voxid("eval", "--index", index, "--scenes", tmp_path, "--unknown").refuses(2)
    voxid("eval", "--index", index, "--queries", queries, "--plot", "x.png").refuses(2)
    (tmp_path / "ball").mkdir()
    answer = voxid("eval", "--index", index, "--queries", queries, "--unknown", "--models", tmp_path)
    answer.refuses(1, "no folder board")


def test_info_says_what_to_expect_only_if_it_was_learnt(voxid, index):
    line = voxid("info", index, "--json").json
    assert line["confidence_samples"] == 0 and line["accuracy_to_expect"] is None
    assert "not known" in voxid("info", index).out
