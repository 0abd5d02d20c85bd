# SPDX-License-Identifier: BSD-3-Clause
"""Rows and fields of `voxid bench`; how fast anything is on this machine is not tested."""
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
        assert 0 <= row["recall10"] <= 1 and 0 <= row["recall1"] <= 1 and row["bytes_per_view"] >= 64
        if name != "query/paper":
            assert (row["peer"], row["peer_median_us"]) == ("query/paper", scan["median_us"])
    assert (searches["query/exact"]["recall1"], searches["query/exact"]["recall10"]) == (1, 1)


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


@pytest.mark.parametrize("bench_of, peer", [("result", "hnswlib"), ("paper_result", "hnswlib"), ("paper_result", "flann")])
def test_other_libraries_search_by_the_same_distance(request, bench_of, peer):
    """FLANN has no distance between signed bytes."""
    searches = rows(request.getfixturevalue(bench_of), "query")
    if f"query/{peer}" not in searches:
        pytest.skip(f"voxid was built without {peer}")
    assert searches[f"query/{peer}"]["curve"][-1]["recall10"] > 0.9


def test_only_what_was_asked_for(voxid, index, queries):
    only = bench(voxid, index, queries, "--only", "descriptor", "--most", 2).json
    assert only["queries"] == 2 and {row["name"].split("/")[0] for row in only["rows"]} == {"descriptor"}


def test_the_table_has_a_line_a_row(voxid, index, queries):
    answer = voxid("bench", "--index", index, "--queries", queries, "--only", "query")
    assert answer.code == 0
    assert [line.split()[0] for line in answer.out.splitlines()[2:5]] == ["query/paper", "query/exact", "query/default"]


def test_bad_use(voxid, index, queries, tmp_path):
    bench(voxid, index, queries, "--only", "speed").refuses(2, "--only")
    bench(voxid, tmp_path / "none.vxi", queries).refuses(1, "none.vxi")
    bench(voxid, index, tmp_path).refuses(1, "queries.csv")
