# SPDX-License-Identifier: BSD-3-Clause
"""voxid eval --memory; what is remembered is tested in test/core/evidence_test.cpp and
test/library/object_memory_test.cpp."""


def test_rows_are_of_all_starts_and_do_not_depend_on_jobs(voxid, index, models):
    ask = ["eval", "--index", index, "--memory", "--unseen", models, "--json"]
    result = voxid(*ask).json
    assert result["models"] == 7 and result["frames"] == 12
    assert [row["frames"] for row in result["rows"]] == [1, 2, 3, 6, 12]
    assert result["rows"][0]["top1"] > 80, "views of the index's own models"
    assert all(abs(row["top1"] - result["one_frame_vote"] - row["minus_vote"]) < 0.02 for row in result["rows"])
    first, last = result["rows"][0], result["rows"][-1]
    assert first["spread_top1"] == first["top1"] and last["spread_top1"] == last["top1"], "one frame, and all of them"
    assert voxid(*ask, "--jobs", 3).json == result
    assert "12 frames" in voxid(*ask[:-1]).out


def test_bad_use(voxid, index, queries, models, tmp_path):
    voxid("eval", "--index", index, "--memory").refuses(2, "--unseen")
    voxid("eval", "--index", index, "--queries", queries, "--unseen", models).refuses(2, "--unseen")
    voxid("eval", "--index", index, "--memory", "--unseen", tmp_path).refuses(3, "no mesh")
