# SPDX-License-Identifier: BSD-3-Clause
"""`voxid train`, and builds with what it wrote."""
import shutil

import pytest


@pytest.fixture(scope="module")
def projection(voxid, models, tmp_path_factory):
    path = tmp_path_factory.mktemp("projection") / "solids.vxp"
    answer = voxid("train", "--models", models, "-o", path, "--lists", 16, "--pairs", 1500, "--jobs", 2)
    assert answer.code == 0, answer.err
    assert "560 views of 7 models in 6 categories" in answer.err
    return path


def build(voxid, models, out, *options):
    return voxid("build", "--models", models, "--out", out, "--views-every", 4, *options)


@pytest.mark.parametrize("code_bytes", [48, 32])
def test_an_index_carries_the_projection_and_finds_its_views(voxid, models, projection, views, tmp_path, code_bytes):
    index = tmp_path / "solids.vxi"
    assert build(voxid, models, index, "--projection", projection, "--bytes", code_bytes).code == 0
    line = voxid("info", index, "--json").json
    assert (line["descriptor"], line["code_bytes"], line["pairs"]) == ("default", code_bytes, 1500)
    assert 1 <= line["buckets"] <= 16 and projection.read_bytes() in index.read_bytes()
    assert voxid("verify", index).code == 0
    answer = voxid("classify", views("cone", "cone_a", 8), "--index", index, "--1nn", "--json").json
    assert answer["label"] == "cone"


def test_the_bytes_do_not_depend_on_jobs(voxid, models, projection, tmp_path):
    again = tmp_path / "again.vxp"
    options = ["--lists", 16, "--pairs", 1500, "--jobs", 1]
    assert voxid("train", "--models", models, "-o", again, *options).code == 0
    assert again.read_bytes() == projection.read_bytes()
    assert not list(tmp_path.glob("*.parts*"))


def test_categories_can_be_left_out(voxid, models, tmp_path):
    (tmp_path / "without.txt").write_bytes(b"# not these\r\ncube\r\n\r\nrod \n")
    answer = voxid("train", "--models", models, "-o", tmp_path / "x.vxp", "--without", tmp_path / "without.txt",
                   "--lists", 8)
    assert answer.code == 0 and "320 views of 4 models in 4 categories" in answer.err


def test_what_cannot_be_learnt_from(voxid, models, tmp_path):
    out = tmp_path / "x.vxp"
    voxid("train", "--models", tmp_path / "none", "-o", out).refuses(1, "none")
    shutil.copytree(models / "cube", tmp_path / "one" / "cube")
    voxid("train", "--models", tmp_path / "one", "-o", out).refuses(3, "two categories")
    voxid("train", "--models", models, "-o", tmp_path / "no" / "x.vxp").refuses(1, "x.vxp")
    assert not out.exists()


def test_wrong_projections_are_refused(voxid, models, tmp_path):
    out, bad = tmp_path / "x.vxi", tmp_path / "bad.vxp"
    build(voxid, models, out, "--projection", tmp_path / "none.vxp").refuses(1, "none.vxp")
    bad.write_bytes(b"no projection" * 100)
    build(voxid, models, out, "--projection", bad).refuses(4, "bad.vxp", "damaged")
    build(voxid, models, out, "--projection", bad, "--descriptor", "paper").refuses(2, "--projection")
    build(voxid, models, out, "--pairs", 500).refuses(2, "--pairs", "paper")
    build(voxid, models, out, "--bytes", 32, "--descriptor", "paper").refuses(2, "--bytes", "default")
    build(voxid, models, out, "--bytes", 64).refuses(2, "--bytes")
    assert not out.exists()
