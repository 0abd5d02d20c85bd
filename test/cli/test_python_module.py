# SPDX-License-Identifier: BSD-3-Clause
"""The Python module: the same answers as the command line, numpy in and out, beside other threads."""
import ast
import os
import pathlib
import shutil
import signal
import subprocess
import threading
import time

import cv2
import numpy as np
import pytest

import solids
import voxid as voxid_module

ROOT = pathlib.Path(__file__).resolve().parents[2]
CAMERA = (525.0, 525.0, 319.5, 239.5)


@pytest.fixture(scope="module")
def image(views):
    return cv2.imread(str(views("tin", "tin_a", 17)), cv2.IMREAD_UNCHANGED)


def test_points_get_the_bins_of_the_command_line(voxid, tmp_path):
    points = np.random.default_rng(3).uniform(-0.2, 0.2, (500, 3)).round(6)
    file = tmp_path / "points.xyz"
    np.savetxt(file, points, fmt="%.6f")
    expected = voxid("describe", file, "--json").json["bins"]
    bins = voxid_module.describe(points)
    assert bins.dtype == np.uint8 and bins.tolist() == expected
    assert voxid_module.describe((points * 1e6).round().astype(np.int32)).tolist() == expected
    assert voxid_module.describe(np.vstack([points, [[np.nan, 0, 0]]])).tolist() == expected
    assert voxid_module.describe(points, pairs=5000).tolist() != expected


def test_degenerate_points_have_bins_or_a_reason():
    describe, i = voxid_module.describe, np.arange(300)
    for few in ([], [(1, 2, 3)], [(1, 2, 3)] * 50):
        with pytest.raises(ValueError):
            describe(np.array(few, np.int32).reshape(-1, 3))
    two = describe(np.array([(0, 0, 0), (1, 1, 1)], np.int32))
    low, high = np.iinfo(np.int32).min, np.iinfo(np.int32).max
    assert describe(np.array([(low,) * 3, (high,) * 3], np.int32)).tolist() == two.tolist()
    many = np.random.default_rng(1).uniform(0, 0.2, (1000000, 3))
    for points in (np.array([(0, 0, 1), (0.1, 0, 1), (0, 0.1, 1)]), np.stack([i, 2 * i, 3 * i], 1) * 1e-3,
                   np.stack([i % 20, i // 20, 0 * i], 1) * 1e-2, many):
        assert describe(points).sum() > 0


def test_a_mesh_is_drawn_as_the_command_line_draws_it(voxid, models, image):
    depth, camera = voxid_module.render(str(models / "tin/tin_a.ply"), 17)
    assert camera == CAMERA and depth.dtype == np.uint16
    assert np.array_equal(depth, image)
    vertices, triangles = solids.turned([(0.0, 0.0), (0.4, 0.0), (0.4, 1.0), (0.0, 1.0)])
    clean, _ = voxid_module.render((vertices, triangles), 17, clean=True)
    assert (clean > 0).sum() > (depth > 0).sum() > 1000


def test_a_whole_model_is_described_as_the_command_line_does(voxid, models):
    file = models / "tin/tin_a.ply"
    expected = voxid("describe", file, "--json").json
    vertices, triangles = mesh = voxid_module.read_mesh(file)
    assert (vertices.dtype, triangles.dtype) == (np.float32, np.uint32)
    assert len(triangles) == expected["triangles"]
    assert np.allclose(np.ptp(vertices, axis=0), expected["extents"], atol=1e-6)
    for form in (str(file), bytes(file), file, mesh):
        assert voxid_module.describe(form).tolist() == expected["bins"]
    assert voxid_module.describe(mesh, pairs=5000).tolist() != expected["bins"]


def test_views_of_a_model_are_near_those_of_its_index(index, models):
    """They differ in size, roll and noise, which follow from a model's name."""
    opened = voxid_module.Index.open(index)
    file = str(models / "board/board_a.ply")
    views = voxid_module.describe_views(file, 8)
    assert (views.dtype, views.shape) == (np.uint8, (10, 48))
    assert np.array_equal(views, voxid_module.describe_views(voxid_module.read_mesh(file), 8))
    found = [opened.categories[opened.place_of(opened.nearest(view, 1)[0][0])[0]] for view in views]
    assert found.count("board") >= 8, found
    with pytest.raises(ValueError, match="1 to 80"):
        voxid_module.describe_views(file, 0)


def test_the_number_of_nearest_views_is_bounded(index, image):
    opened = voxid_module.Index.open(str(index))
    code = opened.describe(image, None, CAMERA)
    assert len(opened.nearest(code)[0]) == 20 and len(opened.nearest(code, 64)[0]) == 64
    with pytest.raises(ValueError, match="1 to 64"):
        opened.nearest(code, 65)


def test_the_nearest_views_are_among_those_that_numpy_finds(index, image):
    """The search measures what it found anew, by codes moved towards their category's mean."""
    opened = voxid_module.Index.open(str(index))
    code = voxid_module.describe(image, None, CAMERA)
    assert code.dtype == np.uint8 and np.array_equal(code, opened.describe(image, image > 0, CAMERA))
    views, distances = opened.nearest(code, 5)
    numbers = voxid_module.numbers(opened.codes).astype(np.int64)
    assert numbers.shape == (len(opened), 96)
    expected = ((numbers - voxid_module.numbers(code)) ** 2).sum(axis=1)
    assert set(views) <= set(np.argsort(expected, kind="stable")[:20])
    assert len(views) == 5 and (np.diff(distances.astype(np.int64)) >= 0).all()
    category, model, direction = opened.place_of(views[0])
    assert (opened.categories[category], opened.models[model]) == ("tin", "tin_a") and 0 <= direction < 80
    assert not opened.codes.flags.writeable
    codes = opened.codes
    del opened
    assert codes[views[0]].any()  # the file stays mapped as long as somebody looks at it


def test_metres_and_cut_out_images_give_the_same_code(image):
    expected = voxid_module.describe(image, None, CAMERA)
    metres = np.where(image > 0, image / np.float32(1000), np.float32(np.nan)).astype(np.float32)
    assert np.array_equal(voxid_module.describe(metres, None, CAMERA), expected)
    wide = np.zeros((image.shape[0], image.shape[1] + 40), np.uint16)
    wide[:, 20:-20] = image
    assert np.array_equal(voxid_module.describe(wide[:, 20:-20], None, CAMERA), expected)  # rows with gaps: no copy
    assert np.array_equal(voxid_module.describe(np.asfortranarray(image), None, CAMERA), expected)


def test_a_paper_index_is_asked_with_bins(paper_index, image):
    opened = voxid_module.Index.open(str(paper_index))
    code = opened.describe(image, None, CAMERA)
    assert code.dtype == np.uint8 and code.shape == (416,)
    views, distances = opened.nearest(code, 5)
    expected = np.abs(opened.codes.astype(int) - code).sum(axis=1)
    order = np.lexsort((np.arange(len(opened)), expected))[:5]
    assert views.tolist() == order.tolist() and distances.tolist() == expected[order].tolist()


def test_an_index_of_small_codes_is_asked_with_small_codes(models, image, tmp_path):
    voxid_module.build(models, tmp_path / "small.vxi", views_every=4, code_bytes=32)
    opened = voxid_module.Index.open(str(tmp_path / "small.vxi"))
    code, codes = opened.describe(image, None, CAMERA), opened.codes
    assert code.dtype == codes.dtype == np.uint8 and code.shape == (32,) and codes.shape == (len(opened), 32)
    numbers = voxid_module.numbers(code)
    assert numbers.dtype == np.int8
    assert numbers.tolist() == (16 * (np.concatenate([code & 15, code >> 4]).astype(int) - 8)).tolist()
    assert voxid_module.numbers(codes).shape == (len(opened), 64)
    with pytest.raises(ValueError, match="48 or 32"):
        voxid_module.numbers(codes[:, :8])
    category, _, _ = opened.place_of(opened.nearest(code)[0][0])
    assert opened.categories[category] == "tin"


def test_parts_make_the_index_of_the_command_line(models, index, tmp_path):
    voxid_module.render(str(models / "tin/tin_a.ply"))  # the processes of a build are forked from what this leaves
    out, told = tmp_path / "parts.vxi", []
    reports = [voxid_module.build(models, out, part=(k, 2), jobs=1) for k in range(2)]
    assert not out.exists() and [(report.models, report.skipped) for report in reports] == [(4, []), (3, [])]
    whole = voxid_module.build(str(models), bytes(out), resume=True, on_progress=lambda *counts: told.append(counts))
    assert out.read_bytes() == index.read_bytes()
    views = sum(report.views for report in reports)
    assert (whole.categories, whole.models, whole.views, whole.bytes) == (6, 7, views, out.stat().st_size)
    assert told[-1] == (7, 7, views)


@pytest.mark.parametrize("words, options", [
    (["--descriptor", "paper", "--pairs", "500"], {"descriptor": "paper", "pairs": 500}),
    (["--keep-points"], {"keep_points": True}),
    (["--bytes", "32"], {"code_bytes": 32}),
    (["--projection", ROOT / "cfg/default.vxp"], {"projection": ROOT / "cfg/default.vxp"})])
def test_options_are_those_of_the_command_line(voxid, models, tmp_path, words, options):
    expected, out = tmp_path / "expected.vxi", tmp_path / "out.vxi"
    assert voxid("build", "--models", models, "--out", expected, "--views-every", 40, *words).code == 0
    voxid_module.build(models, out, views_every=40, **options)
    assert out.read_bytes() == expected.read_bytes()


def test_indices_are_merged_as_by_the_command_line(voxid, models, tmp_path):
    halves = [tmp_path / "tins.vxi", tmp_path / "cubes.vxi"]
    for half, category in zip(halves, ("tin", "cube")):
        (tmp_path / half.stem).mkdir()
        (tmp_path / half.stem / category).symlink_to(models / category)
        voxid_module.build(tmp_path / half.stem, half, views_every=40)
    assert voxid("merge", *halves, "--out", tmp_path / "expected.vxi").code == 0
    voxid_module.merge(halves, tmp_path / "out.vxi")
    assert (tmp_path / "out.vxi").read_bytes() == (tmp_path / "expected.vxi").read_bytes()
    with pytest.raises(OSError, match="tin_a"):
        voxid_module.merge([halves[0], halves[0]], tmp_path / "out.vxi")
    voxid_module.merge([halves[0], halves[0]], tmp_path / "out.vxi", replace=True)
    assert (tmp_path / "out.vxi").read_bytes() == halves[0].read_bytes()
    with pytest.raises(ValueError, match="no index"):
        voxid_module.merge([], tmp_path / "none.vxi")


def test_names_that_are_no_utf_8_can_be_read(models, tmp_path):
    category = os.fsencode(tmp_path / "in") + b"/m\xfcg"
    os.makedirs(category)
    shutil.copy(models / "cube" / "cube_a.ply", category + b"/a\xff.ply")
    voxid_module.build(tmp_path / "in", tmp_path / "x.vxi", views_every=40)
    index = voxid_module.Index.open(tmp_path / "x.vxi")
    assert (index.categories, index.models) == (["m\ufffdg"], ["a\ufffd"])


@pytest.mark.parametrize("error, options, words", [
    (ValueError, {"descriptor": "none"}, "'none': expected default or paper"),
    (ValueError, {"part": (2, 2)}, "no such part"),
    (ValueError, {"pairs": 500}, "descriptor paper"),
    (ValueError, {"descriptor": "paper", "pairs": 0}, "1 to 1000000"),
    (ValueError, {"descriptor": "paper", "code_bytes": 32}, "descriptor default"),
    (ValueError, {"code_bytes": 64}, "32 or 48"),
    (ValueError, {"descriptor": "paper", "projection": "a.vxp"}, "descriptor default"),
    (ValueError, {"jobs": 0}, "1 to 1024"),
    (OSError, {"projection": "absent.vxp"}, "absent.vxp"),
    (OSError, {"models": b"absent \xff"}, "absent \ufffd"),
    (OSError, {"out": "/absent/a.vxi"}, "/absent/a.vxi"),
    (TypeError, {"models": 7}, "int")])
def test_a_build_that_cannot_be_done_is_one_sentence(models, tmp_path, error, options, words):
    with pytest.raises(error, match=words):
        voxid_module.build(**{"models": models, "out": tmp_path / "a.vxi", **options})


def test_a_damaged_library_is_told_from_an_absent_one(tmp_path):
    solids.write_ply(tmp_path / "models/cube/cube_a.ply", solids.box(1.0, 1.0, 1.0))
    (tmp_path / "models/library.json").write_text("[]")
    with pytest.raises(voxid_module.DamagedError, match="library.json"):
        voxid_module.build(tmp_path / "models", tmp_path / "a.vxi")


def test_what_is_skipped_is_in_the_report(models, tmp_path):
    folder = tmp_path / "models"
    shutil.copytree(models / "tin", folder / "tin")
    (folder / "tin" / os.fsdecode(b"cut\xff.ply")).write_text("ply\nformat ascii 1.0\n")
    report = voxid_module.build(folder, tmp_path / "a.vxi", views_every=40)
    ((name, reason),) = report.skipped
    assert report.models == 1 and name == "tin/cut\ufffd.ply" and "header does not end" in reason


class Enough(Exception):
    pass


def raise_after_one(done, *_):
    if done > 0:
        raise Enough()


def interrupt_after_one(parts):
    while not list(parts.glob("*.shard")):
        time.sleep(0.005)
    os.kill(os.getpid(), signal.SIGINT)


@pytest.mark.parametrize("stopped_by", [Enough, KeyboardInterrupt])
def test_a_build_is_stopped_and_resumed(models, index, tmp_path, stopped_by):
    out, parts = tmp_path / "a.vxi", tmp_path / "a.vxi.parts"
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with pytest.raises(stopped_by):
            if stopped_by == KeyboardInterrupt:
                threading.Thread(target=interrupt_after_one, args=(parts,), daemon=True).start()
            voxid_module.build(models, out, jobs=1, on_progress=raise_after_one if stopped_by == Enough else None)
    finally:
        signal.signal(signal.SIGINT, before)
    with pytest.raises(ChildProcessError):
        os.waitpid(-1, os.WNOHANG)
    assert 1 <= len(list(parts.glob("*.shard"))) < 7
    voxid_module.build(models, out, resume=True)
    assert out.read_bytes() == index.read_bytes()


@pytest.mark.parametrize("call", [
    lambda m, i: m.describe(np.zeros((3, 2))),
    lambda m, i: m.describe(np.zeros((5, 3))),
    lambda m, i: m.describe(np.zeros((0, 3))),
    lambda m, i: m.describe(i, i[:5] > 0, CAMERA),
    lambda m, i: m.describe(i, None, (0, 0, 0, 0)),
    lambda m, i: m.describe(i * 0, None, CAMERA),
    lambda m, i: m.describe(i[0], None, CAMERA),
    lambda m, i: m.render(([[0, 0, 0]], [[0, 1, 2]])),
    lambda m, i: m.render(([[0, 0, 0]], [[0, 0, 0]])),
    lambda m, i: m.describe(([[0, 0, 0]], [[0, 0, 0]])),
    lambda m, i: m.describe_views(([[0, 0, 0]], [[0, 1, 2]])),
])
def test_wrong_arguments_are_value_errors(image, call):
    with pytest.raises(ValueError):
        call(voxid_module, image)


def test_files_that_cannot_be_read_are_os_errors(index, tmp_path, image):
    with pytest.raises(TypeError):
        voxid_module.describe(image.astype(np.int64), None, CAMERA)
    for path in ("absent.vxi", "cut.vxi"):
        (tmp_path / "cut.vxi").write_bytes(index.read_bytes()[:5000])
        with pytest.raises(OSError, match=path):
            voxid_module.Index.open(str(tmp_path / path))
    (tmp_path / "cut.ply").write_text("ply\nformat ascii 1.0\n")
    for path in ("absent.ply", "cut.ply"):
        with pytest.raises(OSError, match=path):
            voxid_module.render(str(tmp_path / path))
    for wrong in (7, ("a.ply",), image):
        with pytest.raises(TypeError):
            voxid_module.describe_views(wrong)
    opened = voxid_module.Index.open(str(index))
    with pytest.raises(ValueError):
        opened.nearest(np.zeros(3, np.int8))
    with pytest.raises(IndexError):
        opened.place_of(10 ** 6)


def test_other_threads_run_meanwhile():
    """As long as the lock is held, this thread cannot count."""
    points = np.random.default_rng(1).uniform(-1, 1, (60000, 3))
    working = threading.Thread(target=lambda: [voxid_module.describe(points, pairs=1000000) for _ in range(3)])
    working.start()
    counted = 0
    while working.is_alive():
        counted += 1
        time.sleep(0.001)
    assert counted > 20


def test_threads_share_an_index(index, image):
    opened = voxid_module.Index.open(str(index))
    code = opened.describe(image, None, CAMERA)
    expected = opened.nearest(code)[0].tolist()
    answers = []
    ask = lambda: [answers.append(opened.nearest(code)[0].tolist()) for _ in range(50)]
    threads = [threading.Thread(target=ask) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(answers) == 200 and all(answer == expected for answer in answers)


def test_messages_of_ros_are_found_whichever_comes_first(tmp_path):
    (tmp_path / "voxid" / "msg").mkdir(parents=True)
    (tmp_path / "voxid" / "__init__.py").write_text("")
    (tmp_path / "voxid" / "msg" / "__init__.py").write_text("Objects = 1\n")
    module = ROOT / os.environ.get("VOXID_BUILD", "build") / "python"
    environment = {**os.environ, "PYTHONPATH": f"{module}:{tmp_path}"}
    script = ("import voxid; from voxid.msg import Objects; from voxid.acquire import source; "
              "print(voxid.Index.__name__, Objects)")
    run = subprocess.run(["/usr/bin/python3", "-c", script], env=environment, capture_output=True, text=True)
    assert run.stdout == "Index 1\n", run.stderr


def test_the_stubs_name_what_the_module_has():
    tree = ast.parse((ROOT / "python/voxid/__init__.pyi").read_text())
    functions = [node for node in tree.body if isinstance(node, ast.FunctionDef)]
    classes = [node for node in tree.body if isinstance(node, ast.ClassDef)]
    assert {node.name for node in functions + classes} == set(voxid_module.__all__)
    for node in functions:
        takes_what_is_stubbed(voxid_module, node)
    for node in classes:
        methods = [method for method in node.body if isinstance(method, ast.FunctionDef)]
        bound = getattr(voxid_module, node.name)
        own = {name for name in vars(bound) if not name.startswith("_") or name == "__len__"}
        assert {method.name for method in methods} == own
        for method in methods:
            if not method.decorator_list or method.decorator_list[0].id == "staticmethod":
                takes_what_is_stubbed(bound, method)


def takes_what_is_stubbed(owner, stub):
    documented = getattr(owner, stub.name).__doc__
    names = [argument.arg for argument in stub.args.args + stub.args.kwonlyargs]
    assert all(f"{name}:" in documented for name in names if name != "self"), documented
