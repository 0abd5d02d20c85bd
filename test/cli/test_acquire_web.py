# SPDX-License-Identifier: BSD-3-Clause
"""voxid acquire --source sketchfab against a server on loopback that behaves, and one that does not."""
import json

import pytest

import model_server
import solids
from model_server import Model, Server, glb, gltf_zip, packed

TIN = solids.turned([(0.0, 0.0), (0.4, 0.0), (0.4, 1.0), (0.0, 1.0)])
BALL = solids.ball()
CONE = solids.turned([(0.0, 0.0), (0.5, 0.0), (0.0, 1.2)])


@pytest.fixture
def acquire(voxid, tmp_path, monkeypatch):
    """Runs `voxid acquire mug` against a server; the answer, and its lines by model."""
    monkeypatch.setenv("no_proxy", "127.0.0.1,localhost")
    monkeypatch.setenv("VOXID_SKETCHFAB_TOKEN", model_server.TOKEN)

    def run(server, *options):
        monkeypatch.setenv("VOXID_SKETCHFAB_URL", server.base)
        answer = voxid("acquire", "mug", "--sense", 4, "--depth", 0, "--source", "sketchfab", "--out", tmp_path / "lib",
                       "--yes", "--json",
                       "--timeout", 0.5, *options)
        assert "Traceback" not in answer.err
        return answer, {line["model"]: line for line in answer.lines}

    return run


def ranges_of(server):
    """The Range of every request for a file, None where there was none."""
    return [headers.get("Range") for path, headers in server.asked if path.startswith("/files/")]


def notes_of(tmp_path):
    return json.loads((tmp_path / "lib/library.json").read_text())


def test_models_of_all_pages_come_with_licence_and_author(acquire, tmp_path):
    models = [Model("a1", "Coffee mug", glb(TIN)), Model("b2", "Mug (low poly)", gltf_zip(BALL, folder="x/"), "gltf"),
              Model("c3", "Mug rack", glb(BALL)), Model("d4", "Beer Mug - free", glb(CONE))]
    with Server(models, refusals=[(429, [("Retry-After", "0")]), (503, [])]) as server:
        answer, lines = acquire(server)
        assert answer.code == 0, answer.err
        kept = {name for name, line in lines.items() if line["number"] is not None}
        assert kept == {"mug/sketchfab_a1.glb", "mug/sketchfab_b2.gltf", "mug/sketchfab_d4.glb"}, answer.out
        note = notes_of(tmp_path)["mug/sketchfab_b2.gltf"]
        assert (note["licence"], note["author"], note["url"]) == ("CC Attribution", "Ann", "https://example.org/b2")
        assert not any("Authorization" in headers for path, headers in server.asked if path.startswith("/files/"))
        asked = len(ranges_of(server))
        assert acquire(server)[0].code == 0
        assert len(ranges_of(server)) == asked  # settled
    assert not list((tmp_path / "lib/.parts").iterdir())


def test_a_broken_line_is_taken_up_where_it_broke(acquire, tmp_path):
    data = glb(BALL)
    with Server([Model("a1", "mug", data, breaks=1)]) as server:
        answer, lines = acquire(server)
        assert answer.code == 0, answer.err
    assert ranges_of(server) == [None, f"bytes={len(data) // 2}-"]
    assert (tmp_path / "lib/mug/sketchfab_a1.glb").read_bytes() == data


def test_what_came_waits_for_the_next_run(acquire, tmp_path):
    data = glb(BALL)
    with Server([Model("a1", "mug", data, breaks=4)]) as server:
        answer, lines = acquire(server)
        assert answer.code == 3 and "the line broke" in lines["mug/sketchfab_a1.glb"]["dropped"]
        assert not lines["mug/sketchfab_a1.glb"]["settled"]
        answer, _ = acquire(server)
        assert answer.code == 0, answer.err
        assert ranges_of(server)[-1] == f"bytes={len(data) // 2}-"
    assert (tmp_path / "lib/mug/sketchfab_a1.glb").read_bytes() == data


def test_what_came_whole_before_a_run_was_killed_is_fetched_anew(acquire, tmp_path):
    data = glb(BALL)
    parts = tmp_path / "lib/.parts"
    parts.mkdir(parents=True)
    (parts / "a1.glb.part").write_bytes(data)
    (parts / "a1.glb.etag").write_text('"1"')
    with Server([Model("a1", "mug", data)]) as server:
        answer, _ = acquire(server)
        assert answer.code == 0, answer.out
        assert ranges_of(server) == [f"bytes={len(data)}-", None]
    assert (tmp_path / "lib/mug/sketchfab_a1.glb").read_bytes() == data
    assert not list(parts.iterdir())


# What is wrong with a model: the model, what its line says, whether that settles it.
ODD = {
    "bomb": (gltf_zip(TIN, **{"scene.bin": b"\0" * (8 << 20)}), "gltf", {}, "unpacks to more than the limit", True),
    "escape": (gltf_zip(TIN, **{"../../up.bin": b"1"}), "gltf", {}, "'../../up.bin', outside", True),
    "nomesh": (packed({"readme.txt": "x"}), "gltf", {}, "holds no mesh", True),
    "nozip": (b"PK but no more", "gltf", {}, "no zip archive", True),
    "outside": (packed({"scene.gltf": json.dumps({"buffers": [{"uri": "../../../etc/passwd"}]})}), "gltf", {},
                "has no '../../../etc/passwd'", True),
    "large": (b"\0" * (2 << 20), "glb", {}, "more than the limit", True),
    "larger": (b"\0" * (2 << 20), "glb", {"size": 100}, "more than the limit", True),
    "size": (glb(TIN), "glb", {"size": 99}, "99 were announced", False),
    "notthere": (glb(TIN), "glb", {"code": 404}, "404, it is not there", True),
    "sum": (glb(TIN), "glb", {"sum": b"0" * 32}, "the sha256 sum", False),
    "always500": (glb(TIN), "glb", {"code": 500}, "500", False),
    "nooffer": (glb(TIN), "glb", {"answer": b'{"glb": []}'}, "not offered", True),
    "always429": (glb(TIN), "glb", {"code": 429, "headers": [("Retry-After", "900")]}, "asks to wait 900 s", False),
    "silent": (glb(TIN), "glb", {"sleep_s": 1.5}, "nothing came for 0.5 s", False),
    "fileurl": (glb(TIN), "glb", {"url": "file:///etc/passwd"}, "no http or https address", True),
    "nojson": (glb(TIN), "glb", {"answer": b"<html>"}, "no JSON", False),
    "redirect": (glb(TIN), "glb", {"redirect": "file:///etc/passwd"}, "sends on to where nothing is fetched", True),
    "hello": (b"hello", "glb", {}, "glb", True),
}


def test_each_failure_costs_one_line_and_that_model(acquire, tmp_path):
    models = [Model(name, "mug", data, format_, **habits) for name, (data, format_, habits, _, _) in ODD.items()]
    with Server([*models, Model("z", "mug", glb(CONE))], page=24) as server:
        answer, lines = acquire(server, "--max-mb", 1)
    assert answer.code == 0 and len(answer.err.splitlines()) == 1, answer.err
    assert lines["mug/sketchfab_z.glb"]["number"] == 1
    notes = notes_of(tmp_path)
    for name, (_, format_, _, reason, settled) in ODD.items():
        line = lines[f"mug/sketchfab_{name}.{format_}"]
        assert reason in line["dropped"] and line["settled"] == settled, line
        assert (f"mug/sketchfab_{name}.{format_}" in notes) == settled
    assert sorted(path.name for path in tmp_path.iterdir()) == ["lib"]
    names = sorted(path.name for path in (tmp_path / "lib/mug").glob("[a-z]*"))
    assert names == ["contact_sheet.png", "sketchfab_z.glb"]


def test_a_source_that_always_fails_is_left_alone(acquire):
    with Server([Model(f"m{i}", f"mug {i}", glb(TIN), answer=b"no") for i in range(9)]) as server:
        answer, lines = acquire(server)
    assert answer.code == 3 and len(lines) == 3
    assert "voxid: sketchfab: given up after 3 failures in a row" in answer.err


@pytest.mark.parametrize("text, code, sentence", [
    *[(text, 1, "sketchfab") for text in (b"{", b"[1]", b"{}", b'{"results": 1}')],
    pytest.param(b"[" * 100000, 1, "sketchfab", id="nested"),
    (b'{"results": [{"uid": "../x", "name": "mug"}, 7, {"name": 1}]}', 3, "no model of mug")])
def test_a_search_that_answers_nonsense_is_one_sentence(acquire, text, code, sentence):
    with Server([], text=text) as server:
        answer, lines = acquire(server)
    assert lines == {}
    answer.refuses(code, sentence)


def test_a_next_page_elsewhere_is_not_asked_with_the_token(acquire):
    with Server([], text=b'{"results": [{}], "next": "http://localhost:1/v3/search"}') as server:
        answer, _ = acquire(server)
    answer.refuses(1, "the next page is on another host")


def test_without_or_with_a_wrong_token_it_says_so(acquire, voxid, monkeypatch, tmp_path):
    with Server([Model("a", "mug", glb(TIN))]) as server:
        monkeypatch.setenv("VOXID_SKETCHFAB_TOKEN", "wrong")
        answer, _ = acquire(server)
        answer.refuses(1, "401, the token is not accepted")
    monkeypatch.delenv("VOXID_SKETCHFAB_TOKEN")
    answer = voxid("acquire", "mug", "--sense", 4, "--source", "sketchfab", "--out", tmp_path / "l")
    answer.refuses(2, "VOXID_SKETCHFAB_TOKEN")


def test_nobody_there_is_one_sentence(acquire):
    with Server([]) as server:
        pass
    answer, _ = acquire(server)
    answer.refuses(1, "Connection refused")
