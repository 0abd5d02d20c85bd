# SPDX-License-Identifier: BSD-3-Clause
"""Rows and fields of `voxid bench`; how fast anything is on this machine is not tested."""
import json

import cv2
import numpy as np
import pytest

TIMES = {"name", "median_us", "p99_us", "peer", "peer_median_us", "ratio"}
QUALITY = {"recall1", "recall10", "bytes_per_view"}


def bench(voxid, index, queries, *options):
    return voxid("bench", "--index", index, "--queries", queries, "--json", *options)


@pytest.fixture(scope="module")
def result(voxid, index, queries):
    return bench(voxid, index, queries).json


@pytest.fixture(scope="module")
def paper_result(voxid, paper_index, queries):
    return bench(voxid, paper_index, queries, "--only", "query").json


def rows(result, group):
    return {row["name"]: row for row in result["rows"] if row["name"].startswith(group + "/")}


def test_times_are_positive_and_ratios_are_those_of_the_medians(result):
    assert (result["queries"], result["views"]) == (6, 560)
    assert len({row["name"] for row in result["rows"]}) == len(result["rows"])
    for row in result["rows"]:
        assert TIMES <= set(row)
        assert 0 < row["median_us"] <= row["p99_us"]
        if row["peer"] is not None:
            assert row["ratio"] == pytest.approx(row["peer_median_us"] / row["median_us"], abs=0.01, rel=0.01)


def test_the_descriptor_stands_beside_esf(result):
    descriptors = rows(result, "descriptor")
    assert {"descriptor/paper", "descriptor/default"} <= set(descriptors)
    for row in descriptors.values():
        assert row["peer"] == "pcl::ESFEstimation" and row["peer_median_us"] > 0 and row["objects"] >= 1
    assert descriptors["descriptor/paper/3000"]["points"] == descriptors["descriptor/default/3000"]["points"] == 3000


def test_searches_stand_beside_the_scan(result):
    searches = rows(result, "query")
    assert {"query/paper", "query/exact", "query/default"} <= set(searches)
    scan = searches["query/paper"]
    assert scan["gb_per_s"] > 0 and scan["bytes_per_view"] == 416 and scan["peer"] is None
    for name, row in searches.items():
        assert QUALITY <= set(row)
        assert 0 <= row["recall10"] <= 1 and 0 <= row["recall1"] <= 1 and row["bytes_per_view"] >= 48
        if name != "query/paper":
            assert (row["peer"], row["peer_median_us"]) == ("query/paper", scan["median_us"])
    exact = searches["query/exact"]
    assert (exact["recall1"], exact["recall10"]) == (1, 1)
    read_gb = result["views"] * exact["bytes_per_view"] * 1e-9
    assert exact["gb_per_s"] == pytest.approx(read_gb / (exact["median_us"] * 1e-6), rel=0.02, abs=0.01)


def test_the_papers_key_is_measured_in_its_index(paper_result):
    curve = rows(paper_result, "query")["query/paper_key"]["curve"]
    assert [point["radius_bits"] for point in curve] == [0, 2, 4, 6, 8]
    recalls = [point["recall10"] for point in curve]
    assert recalls == sorted(recalls)


def test_recall_grows_with_what_is_searched(result):
    curve = rows(result, "query")["query/default"]["curve"]
    assert [point["lists"] for point in curve] == [4, 8, 16, 24, 32, 48, 64, 128]
    recalls = [point["recall10"] for point in curve]
    assert recalls == sorted(recalls)


@pytest.mark.parametrize("bench_of, peer",
                         [("result", "hnswlib"), ("paper_result", "hnswlib"), ("paper_result", "flann")])
def test_other_libraries_search_by_the_same_distance(request, bench_of, peer):
    """FLANN has no distance between signed bytes."""
    assert rows(request.getfixturevalue(bench_of), "query")[f"query/{peer}"]["curve"][-1]["recall10"] > 0.9


def test_only_what_was_asked_for(voxid, index, queries):
    only = bench(voxid, index, queries, "--only", "descriptor", "--most", 2).json
    assert only["queries"] == 2 and {row["name"].split("/")[0] for row in only["rows"]} == {"descriptor"}


def test_the_table_has_a_line_a_row(voxid, index, queries):
    answer = voxid("bench", "--index", index, "--queries", queries, "--only", "query")
    assert answer.code == 0
    assert [line.split()[0] for line in answer.out.splitlines()[2:5]] == ["query/paper", "query/exact", "query/default"]


@pytest.fixture(scope="module")
def scenes(put_labelled_table, tmp_path_factory):
    folder = tmp_path_factory.mktemp("scenes")
    put_labelled_table(folder, "a")
    truth = [{"id": number, "truncated": False, "alone_at_2cm": True, "parts": 1} for number in (2, 3)]
    (folder / "objects.json").write_text(json.dumps({"a": {"objects": truth}}))
    return folder


def test_the_segmentation_stands_beside_pcl(voxid, scenes):
    result = voxid("bench", "--scenes", scenes, "--json").json
    assert [row["name"] for row in result["rows"]] == ["segment/vga", "segment/qvga", "segment/full"]
    for row in result["rows"]:
        assert 0 < row["median_us"] <= row["worst_us"]
        assert (row["scenes"], row["objects"], row["right"]) == (1, 2, 2)
        assert (row["peer_right"], row["peer_right_voxels"]) == (2, 2)
        assert row["ratio"] == pytest.approx(row["peer_median_us"] / row["median_us"], abs=0.01, rel=0.01)
        assert row["ratio_voxels"] == pytest.approx(row["peer_median_us_voxels"] / row["median_us"], abs=0.01, rel=0.01)


def test_scenes_of_another_size_are_refused(voxid, scenes, tmp_path):
    (tmp_path / "objects.json").write_text('{"a": {"objects": []}}')
    (tmp_path / "camera_info.yaml").write_text(
        "image_width: 320\nimage_height: 240\n"
        "camera_matrix: {rows: 3, cols: 3, data: [262.5, 0.0, 159.5, 0.0, 262.5, 119.5, 0.0, 0.0, 1.0]}\n")
    for name in ("a_depth.png", "a_labels.png"):
        image = cv2.imread(str(scenes / name), cv2.IMREAD_UNCHANGED)
        assert cv2.imwrite(str(tmp_path / name), image[:240, :320])
    voxid("bench", "--scenes", tmp_path).refuses(1, "320 x 240", "640 x 480")
    (tmp_path / "objects.json").write_text("{}")
    voxid("bench", "--scenes", tmp_path).refuses(3, "objects.json")


@pytest.fixture(scope="module")
def chain(voxid, index, scenes):
    """The row, or the refusal where voxid was built without ROS."""
    answer = voxid("bench", "--chain", "--index", index, "--frames", scenes, "--seconds", 3, "--json")
    if "without" in answer.err:
        answer.refuses(1, "--chain needs ROS", "scripts/build")
        pytest.skip("this voxid was built without ROS")
    return answer.json["rows"]


def test_the_chain_answers_every_frame_it_is_shown(chain):
    (row,) = chain
    assert row["name"] == "chain"
    assert 0 < row["p50_ms"] <= row["p99_ms"] <= row["worst_latency_ms"]
    assert 80 <= row["frames"] <= 100 and 0 <= row["lost"] <= row["frames"] // 2  # a busy machine may be late
    assert row["objects_per_frame"] == 2  # the cube and the tin


def test_the_chain_says_what_a_frame_costs_each_stage(chain):
    (row,) = chain
    stages = row["cpu_ms_per_frame"]
    assert {"all", "capture", "segmentation", "classification", "lcm_bridge", "other"} <= set(stages)
    assert stages["all"] == pytest.approx(sum(ms for name, ms in stages.items() if name != "all"), abs=0.01)
    assert all(stages[name] > 0 for name in ("capture", "segmentation", "classification"))
    assert row["core_share"] == pytest.approx(stages["all"] * row["frames"] / 3000, rel=0.05)


def test_the_chain_aligns_models_if_told(voxid, index, scenes, models, chain):
    answer = voxid("bench", "--chain", "--index", index, "--frames", scenes, "--seconds", 3, "--align", "all",
                   "--models", models, "--json")
    (row,) = answer.json["rows"]
    assert chain[0]["aligned_per_frame"] == 0
    assert 0 <= row["aligned_per_frame"] <= row["objects_per_frame"] == 2  # a busy machine may come to none


def test_bad_use_of_the_chain(voxid, index, scenes, tmp_path):
    voxid("bench", "--chain", "--index", index, "--frames", scenes, "--align", "all").refuses(2, "--models")
    voxid("bench", "--chain", "--index", index).refuses(2, "--scenes", "--frames")
    voxid("bench", "--chain", "--frames", scenes).refuses(2, "--index")
    voxid("bench", "--frames", scenes, "--scenes", scenes).refuses(2, "--chain")
    voxid("bench", "--chain", "--index", tmp_path / "none.vxi", "--frames", scenes).refuses(1, "none.vxi")
    voxid("bench", "--chain", "--index", index, "--frames", tmp_path / "none").refuses(1, "none")


def test_bad_use(voxid, index, queries, tmp_path):
    voxid("bench").refuses(2, "--queries", "--scenes")
    voxid("bench", "--queries", queries).refuses(2, "--index")
    voxid("bench", "--scenes", tmp_path).refuses(1, "objects.json")
    bench(voxid, index, queries, "--only", "speed").refuses(2, "--only")
    bench(voxid, tmp_path / "none.vxi", queries).refuses(1, "none.vxi")
    bench(voxid, index, tmp_path).refuses(1, "queries.csv")


def test_the_curves_are_drawn(voxid, index, queries, tmp_path):
    """Every search is named in its colour, and something of these colours is in the plot."""
    path = tmp_path / "curves.png"
    assert voxid("bench", "--index", index, "--queries", queries, "--only", "query", "--plot", path).code == 0
    picture = cv2.imread(str(path)).astype(int)
    plot, names = picture[30:541, 80:717], picture[30:541, 717:]
    colours = [[40, 30, 210], [200, 110, 30], [80, 180, 70]]  # of the scan, every view, lists
    shown = [[(np.abs(part - colour).max(axis=2) < 60).sum() for colour in colours] for part in (plot, names)]
    assert sum(shown[0]) >= 9 and min(shown[1]) >= 9


def test_curves_need_queries(voxid, tmp_path):
    voxid("bench", "--scenes", tmp_path, "--plot", tmp_path / "x.png").refuses(2, "--plot", "--queries")


def test_an_index_as_large_as_wanted_is_written_measured_and_sound(voxid, index, queries, tmp_path):
    own = voxid("info", index, "--json").json
    out = tmp_path / "large.vxi"
    answer = bench(voxid, index, queries, "--scale", 5 * own["views"] - 1, "--scale-out", out)
    assert answer.code == 0, answer.err
    scale = answer.json["scale"]
    assert scale["views"] == 5 * own["views"] and scale["models"] == 5 * own["models"]
    assert scale["bytes"] == out.stat().st_size
    assert voxid("verify", out).code == 0
    assert [row["lists"] for row in scale["lists"]] == [4, 8, 16, 32, 64, 128, 256, 512]
    assert scale["lists"][-1]["recall10"] > 0.95
    as_it_is = bench(voxid, out, queries, "--scale", 1).json["scale"]
    assert as_it_is["views"] == scale["views"] and "write_s" not in as_it_is
    for row, same in zip(scale["lists"], as_it_is["lists"]):
        assert all(row[field] == same[field] for field in ("recall1", "recall10", "compared"))


def test_the_large_index_of_a_temporary_folder_is_removed(voxid, index, queries, tmp_path, monkeypatch):
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    assert voxid("bench", "--index", index, "--queries", queries, "--scale", 1000).code == 0
    assert list(tmp_path.iterdir()) == []


def test_scale_needs_queries(voxid, index):
    answer = voxid("bench", "--index", index, "--scale", 1000)
    assert answer.code == 2 and "--queries" in answer.err
