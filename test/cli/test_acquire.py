# SPDX-License-Identifier: BSD-3-Clause
"""voxid acquire and library."""
import json
import pathlib
import subprocess
import sys

import pytest
import yaml

import solids

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "python"))
from voxid.acquire import meaning, source  # noqa: E402

TABLE = yaml.safe_load((ROOT / "cfg/synsets.yaml").read_text())


@pytest.fixture(scope="module")
def wordnet():
    with meaning.WordNet() as opened:
        yield opened


@pytest.fixture
def meshes(tmp_path):
    """A mug, the same again under another name, another mug, a broken one, an empty one, and something else."""
    folder = tmp_path / "meshes"
    tin = solids.turned([(0.0, 0.0), (0.4, 0.0), (0.4, 1.0), (0.0, 1.0)])
    solids.write_ply(folder / "beer mug.ply", tin)
    solids.write_ply(folder / "coffee mug.ply", ([(3 * y, 3 * z, 3 * x) for x, y, z in tin[0]], tin[1]))
    solids.write_ply(folder / "mug 7.ply", solids.ball())
    solids.write_ply(folder / "mug rack.ply", solids.box(1, 1, 1))
    (folder / "mug 8.obj").write_text("")
    (folder / "mug 9.ply").write_text("ply\nformat binary_little_endian 1.0\nelement vertex 250000000\n"
                                      "property float x\n"
                                      "property float y\nproperty float z\nend_header\n")
    return folder


def test_table_agrees_with_wordnet(wordnet):
    wrong = [category for category, (name, offset) in TABLE["categories"].items()
             if wordnet.synset(name).offset() != offset or wordnet.synset(name).pos() != "n"]
    assert wrong == []


def test_hypernyms_follow_from_the_table_and_wordnet(wordnet):
    done = subprocess.run(["/usr/bin/python3", ROOT / "scripts/generate_hypernyms", "--check"], capture_output=True,
                          text=True)
    assert (done.returncode, done.stderr) == (0, "")


def test_table_has_the_papers_table_1_under_its_coarse_categories(wordnet):
    for coarse, names in TABLE["table_1"].items():
        for name in names:
            synset = wordnet.synset(TABLE["categories"][name][0])
            above = {wider for path in synset.hypernym_paths() for wider in path}
            assert (wordnet.synset(coarse) in above) != (name in TABLE["table_1_elsewhere"].get(coarse, [])), name


def test_table_covers_the_training_models():
    train = ROOT / "../shared/data/models/train"
    if not train.is_dir():
        pytest.skip("../shared/data/models/train is not there")
    assert {path.name for path in train.iterdir()} - set(TABLE["categories"]) == set()


def test_without_a_terminal_the_senses_are_listed_and_it_ends(voxid):
    answer = voxid("acquire", "mug", "--json")
    answer.refuses(2, "--sense", "4 (mug.n.04)")
    senses = answer.lines
    names = {s["sense"]: s["name"] for s in senses}
    assert names == {1: "mug.n.01", 2: "chump.n.01", 3: "countenance.n.03", 4: "mug.n.04"}
    assert senses[0]["sense"] in (3, 4) and senses[-1]["sense"] in (1, 2)


def test_spaces_between_words_do_not_matter(voxid):
    answer = voxid("acquire", "  coffee   mug ", "--sense", 1, "--explain", "--json")
    assert answer.code == 0 and answer.lines[0]["word"] == "coffee mug", answer.err


def test_words_say_where_they_come_from(voxid):
    answer = voxid("acquire", "mug", "--sense", 4, "--explain", "--json")
    assert answer.code == 0, answer.err
    words = {line["word"]: (line["origin"], line["about"]) for line in answer.lines}
    assert words["mug"] == ("lemma", "mug.n.04")
    assert words["coffee mug"] == ("hyponym", "coffee_mug.n.01")
    assert words["taza"] == ("translation", "spa, reviewed")


def test_bad_use_is_one_sentence(voxid, tmp_path):
    for wrong in ("9", "-1"):
        voxid("acquire", "mug", f"--sense={wrong}", "--explain").refuses(2, f"--sense {wrong}", "4 (mug.n.04)")
    voxid("acquire", "qqqqx", "--explain").refuses(3, "qqqqx")
    for wrong in ("../mug", "caf\u00e9", ""):
        voxid("acquire", wrong, "--explain").refuses(2, wrong, "letters a to z")
    voxid("acquire", "mug", "--sense", 4).refuses(2, "--source")
    voxid("acquire", "mug", "--frobnicate").refuses(2, "--frobnicate")
    voxid("acquire", "mug", "--sense", 4, "--source", tmp_path / "none", "--out", tmp_path / "lib").refuses(1, "none")
    voxid("library", "list", tmp_path).refuses(1, "library.json")


def test_titles_are_matched_by_what_they_name():
    assert source.names("Coffee-Mug_28", "mug") and source.names("Bowls with fruit", "bowl")
    assert not source.names("Mug rack", "mug") and not source.names("Smug", "mug")


def test_a_folder_is_judged_once_and_built(voxid, meshes, tmp_path):
    library = tmp_path / "lib"
    command = ("acquire", "mug", "--sense", "mug.n.04", "--source", meshes, "--out", library)
    voxid(*command).refuses(2, "--keep", "contact_sheet.png")
    assert not (library / "library.json").exists()
    answer = voxid(*command, "--yes", "--json")
    assert answer.code == 0, answer.err
    dropped = {line["model"]: line["dropped"] for line in answer.lines if line["number"] is None}
    assert set(dropped) == {"mug/folder_coffee_mug.ply", "mug/folder_mug_8.obj", "mug/folder_mug_9.ply"}
    assert dropped["mug/folder_coffee_mug.ply"] == "the same shape as mug/folder_beer_mug.ply"
    assert (library / "mug/contact_sheet.png").read_bytes()[:4] == b"\x89PNG"
    notes = json.loads((library / "library.json").read_text())
    assert notes["mug"]["synset"] == "03797390"
    before = (library / "library.json").read_bytes()
    assert voxid(*command, "--yes").code == 0
    assert (library / "library.json").read_bytes() == before
    index = tmp_path / "a.vxi"
    assert voxid("build", "--models", library, "--out", index, "--views-every", 16).code == 0
    assert voxid("info", index, "--json", "--categories").json["category_list"] == [
        {"name": "mug", "synset": 3797390, "sense": "mug.n.04", "models": 2}]
    voxid("acquire", "mug", "--sense", 1, "--source", meshes, "--out", library, "--yes").refuses(2, "03797390")


@pytest.mark.parametrize("synset", ["03797390", "n03797390", 3797390])
def test_another_word_for_what_a_category_holds_is_no_second_category(voxid, meshes, tmp_path, synset):
    library = tmp_path / "lib"
    library.mkdir()
    (library / "library.json").write_text(json.dumps({"mug": {"synset": synset}}))
    command = ("--sense", "mug.n.04", "--depth", 0, "--source", meshes, "--out", library, "--yes")
    voxid("acquire", "mugs", *command).refuses(2, "mug.n.04 already, as mug, not mugs", "voxid acquire mug")
    assert [path.name for path in library.iterdir() if path.is_dir()] == []
    assert voxid("acquire", "mug", *command).code == 0


def test_a_shapenet_mirror_is_found_by_its_offsets(voxid, tmp_path):
    mirror = tmp_path / "shapenet"
    solids.write_ply(mirror / "03797390" / "1a2b" / "models" / "model_normalized.ply", solids.ball())
    solids.write_ply(mirror / "02876657" / "9f" / "models" / "model_normalized.ply", solids.box(1, 1, 1))
    (mirror / "taxonomy.json").write_text(json.dumps([{"synsetId": "03797390", "name": "mug", "children": []}]))
    answer = voxid("acquire", "mug", "--sense", 4, "--source", mirror, "--out", tmp_path / "lib", "--yes", "--json")
    assert [line["model"] for line in answer.lines] == ["mug/shapenet_03797390_1a2b.ply"], answer.err


def test_licences_of_debians_catalogues_are_listed(voxid, tmp_path):
    answer = voxid("acquire", "mug", "--sense", 4, "--source", "sweethome3d", "--yes", "--out", tmp_path / "lib")
    assert answer.code == 0, answer.err
    (line,) = voxid("library", "licences", tmp_path / "lib", "--json").lines
    assert line["licence"] == "CC-BY-3.0-US"
    authors = [(m["model"], m["author"]) for m in line["models"]]
    assert authors == [("mug/sh3d_katorlegaz_coffee_mug.obj", "Kator Legaz")]
