# SPDX-License-Identifier: BSD-3-Clause
import pathlib
import shutil

import cv2
import numpy as np
import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]

CATEGORIES = {"ball": 1, "board": 1, "cone": 1, "cube": 2, "rod": 1, "tin": 1}


def timeless(result):
    return {**result, "rows": [{k: v for k, v in row.items() if k != "us_per_query"} for row in result["rows"]]}


def test_info(voxid, index):
    line = voxid("info", index, "--json").json
    assert (line["models"], line["views"], line["categories"]) == (7, 560, 6)
    assert line["bytes"] == index.stat().st_size
    assert line["bytes_per_view"] == pytest.approx(line["bytes"] / 560)
    assert line["descriptor"] == "default" and line["version"] == "1.3" and line["code_bytes"] == 48
    assert line["seed"] == 1
    assert 0 < line["buckets"] <= 560
    assert sum(entry["models"] for entry in line["licences"]) == 7
    assert "category_list" not in line
    listed = voxid("info", index, "--json", "--categories").json["category_list"]
    assert {entry["name"]: entry["models"] for entry in listed} == CATEGORIES
    text = voxid("info", index)
    assert text.code == 0 and "models       7" in text.out and "cube" not in text.out
    assert "cube" in voxid("info", index, "--categories").out


def test_info_of_the_papers_descriptor(voxid, paper_index):
    line = voxid("info", paper_index, "--json").json
    assert line["descriptor"] == "paper" and line["version"] == "1.3" and line["code_bytes"] == 416
    assert (line["pairs"], line["seed"]) == (10000, 1)


def test_eval_counts_right_answers(voxid, index, queries):
    result = voxid("eval", "--index", index, "--queries", queries, "--json").json
    assert result["queries"] == 6
    assert [row["method"] for row in result["rows"]] == ["1nn", "vote"]
    nearest = result["rows"][0]
    assert nearest["descriptor"] == "default"
    assert nearest["top1"] == pytest.approx(100 * 5 / 6, abs=0.01)
    assert nearest["mean_category"] == pytest.approx(100 * 4 / 5, abs=0.01)
    assert nearest["top5"] == pytest.approx(100 * 5 / 6, abs=0.01)
    assert nearest["us_per_query"] > 0
    assert nearest["bytes_per_view"] == pytest.approx(index.stat().st_size / 560, abs=0.01)
    low, high = nearest["top1_95"]
    assert 0 <= low <= nearest["top1"] <= high <= 100 and low < high


def test_eval_does_not_depend_on_jobs(voxid, index, queries):
    results = [voxid("eval", "--index", index, "--queries", queries, "--json", "--jobs", jobs).json
               for jobs in (1, 2, 5)]
    assert timeless(results[0]) == timeless(results[1]) == timeless(results[2])


def test_every_takes_each_nth(voxid, index, queries):
    result = voxid("eval", "--index", index, "--queries", queries, "--json", "--every", 3).json
    assert result["queries"] == 2 and result["rows"][0]["top1"] == 100


def test_the_table_has_a_row_a_method(voxid, index, queries, tmp_path):
    answer = voxid("eval", "--index", index, "--queries", queries, "--confusion", tmp_path / "c.png")
    assert (answer.code, answer.err) == (0, "")
    lines = answer.out.splitlines()
    assert [line.split()[:2] for line in lines[2:4]] == [["default", "1nn"], ["default", "vote"]]
    assert lines[4].startswith("by vote, as synsets: top-1 ") and len(lines) == 5
    assert "83.33" in answer.out


def test_the_picture_of_the_confusion(voxid, index, queries, tmp_path):
    """A row a category that was asked for: green where it is right, which `moon` never is, and a summary at its end."""
    assert voxid("eval", "--index", index, "--queries", queries, "--confusion", tmp_path / "c.png").code == 0
    picture = cv2.imread(str(tmp_path / "c.png")).astype(int)
    names, summary, cell = 130, 200, 11
    rows, columns = (picture.shape[0] - names) // cell, (picture.shape[1] - names - summary) // cell
    asked = sorted({line.split(",")[1] for line in (queries / "queries.csv").read_text().split()[1:]})
    assert rows == len(asked) == 5
    centres = picture[names + 5::cell, names + 5:-summary:cell][:rows, :columns]
    green = centres[:, :, 1] > centres[:, :, 2] + 20
    right = [(row, row) for row in range(rows) if asked[row] != "moon"]
    assert list(zip(*np.nonzero(green))) == right and columns >= rows
    end = picture[names:, -summary:]
    assert all((end[cell * row:cell * (row + 1)] < 128).any() for row in range(rows))
    assert (picture[:names, -summary:] == 255).all()


def test_bad_queries(voxid, index, queries, tmp_path):
    def refused(code, *words):
        voxid("eval", "--index", index, "--queries", tmp_path, "--json").refuses(code, *words)

    table = tmp_path / "queries.csv"
    refused(1, "queries.csv")
    table.touch()
    refused(4, "empty")
    table.write_text("file,category\na.png,b\n")
    refused(1, "column model")
    table.write_text("file,category,model\n")
    refused(3, "no query")
    table.write_text("file,category,model\na.png,b\n")
    refused(1, "line 2")
    table.write_text("file,category,model\na.png,b,c\nz.png,b,c\n")
    refused(1, "a.png", "no such file")
    voxid("eval", "--index", tmp_path / "none.vxi", "--queries", queries).refuses(1, "none.vxi")


def test_a_byte_order_mark_is_no_part_of_the_first_name(voxid, index, queries, tmp_path):
    for path in queries.iterdir():
        if path.name != "queries.csv":
            (tmp_path / path.name).symlink_to(path)
    (tmp_path / "queries.csv").write_text((queries / "queries.csv").read_text(), encoding="utf-8-sig")
    assert voxid("eval", "--index", index, "--queries", tmp_path, "--json").json["queries"] == 6


def test_the_real_queries(voxid, index):
    folder = ROOT / "../shared/data/queries/dev"
    if not folder.exists():
        pytest.skip("../shared/data/queries/dev is not there")
    result = voxid("eval", "--index", index, "--queries", folder, "--every", 100, "--json").json
    assert result["queries"] == 14


@pytest.fixture(scope="module")
def comparison(voxid, index, queries, models):
    return voxid("eval", "--index", index, "--queries", queries, "--compare", "--models", models, "--every", 8,
                 "--jobs", 2, "--json").json


def test_compare_has_a_row_a_descriptor_and_method(comparison):
    assert (comparison["queries"], comparison["views"], comparison["every"]) == (6, 70, 8)
    names = [(row["descriptor"], row["method"]) for row in comparison["rows"]]
    assert len(set(names)) == len(names)
    assert {(d, m) for d in ("esf", "esf_projected", "d2", "paper_float", "paper", "default")
            for m in ("1nn", "vote")} <= set(names)
    for row in comparison["rows"]:
        assert 0 <= row["mean_category"] <= 100 and row["top1"] <= row["top5"] <= 100
        assert row["us_per_query"] > 0
        if row["descriptor"] == "esf":
            assert row["bytes_per_view"] == 2560 and row["minus_esf"] is None
        else:
            low, high = row["minus_esf_95"]
            assert low <= row["minus_esf"] <= high


def test_differences_are_those_of_the_rows(comparison):
    top1 = {(row["descriptor"], row["method"]): row["top1"] for row in comparison["rows"]}
    for row in comparison["rows"]:
        if row["minus_esf"] is not None:
            assert row["minus_esf"] == pytest.approx(row["top1"] - top1["esf", row["method"]], abs=0.02)


@pytest.mark.parametrize("descriptor", ["paper", "default"])
def test_a_row_is_what_the_index_says(voxid, models, queries, comparison, tmp_path, descriptor):
    """The same views from `build` and from `--compare` give the same answers."""
    built = tmp_path / "every8.vxi"
    assert voxid("build", "--models", models, "--out", built, "--views-every", 8, "--descriptor", descriptor).code == 0
    own = {row["method"]: row for row in voxid("eval", "--index", built, "--queries", queries, "--json").json["rows"]}
    for row in comparison["rows"]:
        if row["descriptor"] == descriptor:
            assert all(row[field] == own[row["method"]][field]
                       for field in ("top1", "mean_category", "top5", "top1_95"))


def test_floats_hardly_differ_from_bytes(comparison):
    top1 = {(row["descriptor"], row["method"]): row["top1"] for row in comparison["rows"]}
    assert top1["paper_float", "1nn"] == pytest.approx(top1["paper", "1nn"], abs=100 / 6 + 0.01)


def test_compare_needs_the_models_of_the_index(voxid, index, queries, models, tmp_path):
    def refused(code, *words, folder=None):
        more = [] if folder is None else ["--models", folder]
        voxid("eval", "--index", index, "--queries", queries, "--compare", "--every", 40, *more).refuses(code, *words)

    refused(2, "--models")
    refused(1, "ball_a", folder=tmp_path)
    other = tmp_path / "other"
    shutil.copytree(models, other)
    shutil.copy(models / "cube" / "cube_b.ply", other / "cube" / "cube_a.ply")
    refused(1, "cube/cube_a", "looks different", folder=other)
