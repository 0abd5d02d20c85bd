# SPDX-License-Identifier: BSD-3-Clause
"""`voxid eval --scenes` on a rendered table whose truth is known, and on the real ones."""
import json
import pathlib

import pytest
import yaml

ROOT = pathlib.Path(__file__).resolve().parents[2]


def truth(number, category, **more):
    return {"id": number, "category": category, "alone_at_2cm": True, "truncated": False, **more}


@pytest.fixture(scope="module")
def scenes(put_labelled_table, tmp_path_factory):
    """A cube (called block) and a tin on a table, objects 2 and 3 of the labels; a second scene with nothing to ask
    for."""
    folder = tmp_path_factory.mktemp("scenes")
    put_labelled_table(folder, "a", "b")
    objects = {"a": [truth(2, "block"), truth(3, "tin")],
               "b": [truth(2, "block", alone_at_2cm=False), truth(3, "tin", exclude="wrong"), truth(3, "unicorn")]}
    (folder / "objects.json").write_text(json.dumps({name: {"objects": list_} for name, list_ in objects.items()}))
    (folder / "aliases.json").write_text('{"block": ["cube", "dice"], "tin": ["tin"]}')
    return folder


def evaluate(voxid, index, scenes, *options):
    return voxid("eval", "--index", index, "--scenes", scenes, "--aliases", scenes / "aliases.json", "--json", *options)


def by_key(result):
    rows = {(row["descriptor"], row["mask"], row["choice"]): row for row in result["rows"]}
    assert len(rows) == len(result["rows"])
    return rows


def test_objects_that_stand_alone_are_asked_for(voxid, index, scenes):
    result = evaluate(voxid, index, scenes).json
    assert (result["scenes"], result["objects"], result["segmented"]) == (2, 2, 2)
    assert result["left_out"] == {"unicorn": 1}
    rows = by_key(result)
    assert set(rows) == {("default", mask, "all") for mask in ("true", "own")}
    for row in rows.values():
        assert row["objects"] == 2
        assert {c["class"]: c["objects"] for c in row["classes"]} == {"cube": 1, "tin": 1}
        assert row["mean_category"] == pytest.approx(sum(c["top1"] for c in row["classes"]) / 2)
        assert row["top5"] == 100  # five of six categories
    assert rows["default", "true", "all"]["top1"] >= 50


def test_listed_categories_alone_are_answers(voxid, index, scenes, tmp_path):
    chosen = tmp_path / "list.txt"
    chosen.write_text("cube\r\n\nunicorn\n")
    rows = by_key(evaluate(voxid, index, scenes, "--categories", chosen).json)
    assert {key[2] for key in rows} == {"all", "listed"}
    listed = rows["default", "true", "listed"]
    assert listed["top1"] == listed["top5"] == 50
    assert {c["class"]: c["mostly_taken_for"] for c in listed["classes"]} == {"cube": "", "tin": "cube"}


def test_look_alikes_count_as_one(voxid, index, scenes, tmp_path):
    chosen, alike = tmp_path / "list.txt", tmp_path / "alike.yaml"
    chosen.write_text("cube\n")
    alike.write_text("groups: {solid: {cube: flat faces, tin: round, dice: small}}\n")
    options = ["--categories", chosen, "--look-alikes", alike]
    listed = by_key(evaluate(voxid, index, scenes, *options).json)["default", "true", "listed"]
    assert listed["top1"] == 50
    assert listed["merged"] == {"top1": 100, "mean_category": 100, "top5": 100}
    plain = by_key(evaluate(voxid, index, scenes).json)["default", "true", "all"]
    own = {field: plain[field] for field in ("top1", "mean_category", "top5")}
    assert plain["merged"] == own  # voxid's own has neither
    answer = voxid("eval", "--index", index, "--scenes", scenes, "--aliases", scenes / "aliases.json", *options)
    assert answer.out.count("look alike as one: top-1 100.00 %") == 4

    alike.write_text("groups: {a: {cube: x}, b: {cube: y}}\n")
    evaluate(voxid, index, scenes, "--look-alikes", alike).refuses(4, "cube is in two groups")
    alike.write_text("groups: [cube]\n")
    evaluate(voxid, index, scenes, "--look-alikes", alike).refuses(4, "alike.yaml")
    evaluate(voxid, index, scenes, "--look-alikes", tmp_path / "none.yaml").refuses(1, "none.yaml")


def test_esf_stands_beside_on_the_same_views(voxid, index, scenes, models):
    result = evaluate(voxid, index, scenes, "--compare", "--models", models, "--every", 8).json
    assert result["every"] == 8
    assert {(d, "true", "all") for d in ("esf", "d2", "paper", "default")} <= set(by_key(result))


def test_the_table_names_what_was_left_out(voxid, index, scenes):
    answer = voxid("eval", "--index", index, "--scenes", scenes, "--aliases", scenes / "aliases.json")
    assert answer.code == 0
    assert "left out: unicorn, 1 object:" in answer.out and "default, mask own" in answer.out


def test_bad_use_and_bad_files(voxid, index, scenes, queries, tmp_path):
    voxid("eval", "--index", index).refuses(2, "--queries", "--scenes")
    voxid("eval", "--index", index, "--queries", queries, "--scenes", scenes).refuses(2, "--scenes")
    voxid("eval", "--index", index, "--queries", queries, "--categories", "x").refuses(2, "--scenes")
    evaluate(voxid, index, scenes, "--compare").refuses(2, "--models")
    evaluate(voxid, index, scenes, "--categories", tmp_path / "none.txt").refuses(1, "none.txt")
    (tmp_path / "other.txt").write_text("unicorn\n")
    evaluate(voxid, index, scenes, "--categories", tmp_path / "other.txt").refuses(1, "other.txt")

    def refused(code, *words):
        voxid("eval", "--index", index, "--scenes", tmp_path).refuses(code, *words)

    refused(1, "objects.json")
    (tmp_path / "objects.json").write_text("[]")
    refused(4, "objects.json")
    (tmp_path / "objects.json").write_text('{"a": {}}')
    refused(1, "a_depth.png")
    (tmp_path / "objects.json").write_text("{}")
    refused(3, "no object")


def test_the_real_scenes(voxid, index):
    folder = ROOT / "../shared/data/scenes/mosd"
    if not folder.exists():
        pytest.skip("../shared/data/scenes/mosd is not there")
    named = json.loads((ROOT / "cfg" / "aliases.json").read_text())
    assert named["tin"] == ["can"] and named["pot"] == []
    answer = voxid("eval", "--index", index, "--scenes", folder)
    answer.refuses(3, "no object")  # the solids of this test are not what stands there


def test_the_look_alikes_are_taught_and_each_says_why():
    groups = yaml.safe_load((ROOT / "cfg" / "look_alikes.yaml").read_text())["groups"]
    members = [member for group in groups.values() for member in group]
    assert len(members) == len(set(members)) and all(len(group) > 1 for group in groups.values())
    assert all(len(why) > 5 for group in groups.values() for why in group.values())
    folder = ROOT / "../shared/data/models/train"
    if folder.exists():
        assert [member for member in members if not (folder / member).is_dir()] == []


def test_the_table_top_list_names_taught_categories_once():
    names = (ROOT / "cfg" / "table_top.txt").read_text().splitlines()
    assert len(names) >= 50 and names == sorted(set(names))
    folder = ROOT / "../shared/data/models/train"
    if not folder.exists():
        pytest.skip("../shared/data/models/train is not there")
    assert [name for name in names if not (folder / name).is_dir()] == []


def test_what_is_too_large_is_not_called_so(voxid, models, scenes, tmp_path):
    """A cube of 12 cm is no die, even where a die is the only cube that was taught."""
    for category, model in (("die", "cube/cube_a.ply"), ("box", "board/board.ply"), ("can", "tin/tin_a.ply")):
        mesh = next((models / model.split("/")[0]).glob("*.ply"))
        (tmp_path / "models" / category).mkdir(parents=True)
        (tmp_path / "models" / category / mesh.name).write_bytes(mesh.read_bytes())
    index, aliases = tmp_path / "x.vxi", tmp_path / "aliases.json"
    assert voxid("build", "--models", tmp_path / "models", "--out", index, "--views-every", 4).code == 0
    aliases.write_text('{"block": ["die"], "tin": ["can"]}')
    ask = ["eval", "--index", index, "--scenes", scenes, "--aliases", aliases, "--json"]
    without, sized = voxid(*ask).json, voxid(*ask, "--evidence", "size").json
    share = {name: {c["class"]: c["top5"] for c in result["rows"][0]["classes"]} for name, result in
             (("without", without), ("sized", sized))}
    assert share == {"without": {"die": 100, "can": 100}, "sized": {"die": 0, "can": 100}}
    assert without["evidence"] == [] and sized["evidence"] == ["size"]
    voxid(*ask, "--evidence", "size,colour").refuses(2, "colour")

    confirmed = tmp_path / "confirmed.yaml"
    confirmed.write_text("die: [180]\n")  # from corner to corner
    sized = [*ask, "--evidence", "size", "--confirmed-sizes"]
    rows = voxid(*sized, confirmed).json["rows"]
    assert {c["class"]: c["top5"] for c in rows[0]["classes"]} == {"die": 100, "can": 100}
    look = ["classify", scenes / "a_depth.png", "--scene", "--index", index, "--evidence", "size", "--json"]
    labels = [{a["label"] for thing in voxid(*look, *more).json["objects"] for a in thing["alternatives"]}
              for more in ([], ["--confirmed-sizes", confirmed])]
    assert labels == [{"box", "can"}, {"box", "can", "die"}]
    confirmed.write_text("damaged")
    voxid(*sized, confirmed).refuses(2, "confirmed.yaml: no file of confirmed sizes")
    voxid(*sized, tmp_path / "nowhere.yaml").refuses(2, "nowhere.yaml")
    confirmed.write_text("")
    voxid(*ask, "--confirmed-sizes", confirmed).refuses(2, "--confirmed-sizes is for --evidence size")


def test_sizes_are_of_taught_categories_once():
    table = yaml.safe_load((ROOT / "cfg/sizes.yaml").read_text())
    known = yaml.safe_load((ROOT / "cfg/synsets.yaml").read_text())["categories"]
    named = list(table["range_cm"]) + table["large"]
    assert len(named) == len(set(named))
    assert set(named) <= set(known)
    assert all(0 < least < most for least, most in table["range_cm"].values())
