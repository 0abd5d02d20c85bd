# SPDX-License-Identifier: BSD-3-Clause
"""The built `voxid`, run as a program, on small files that the tests make."""
import json
import os
import pathlib
import subprocess
import sys

import cv2
import numpy as np
import pytest

import solids

ROOT = pathlib.Path(__file__).resolve().parents[2]
# The compiled part of the Python module; found also by tests that put the sources first.
sys.path.append(str(ROOT / os.environ.get("VOXID_BUILD", "build") / "python"))
QUERIES = [("tin", "tin_a", 17), ("tin", "tin_a", 40), ("cone", "cone_a", 3), ("rod", "rod_a", 5),
           ("board", "board_a", 64)]


class Answer:
    """What a run printed and how it ended."""

    def __init__(self, run):
        self.code, self.out, self.err = run.returncode, run.stdout, run.stderr

    @property
    def lines(self):
        return [json.loads(line) for line in self.out.splitlines()]

    @property
    def json(self):
        assert self.code == 0, self.err
        (line,) = self.lines
        return line

    def refuses(self, code, *words):
        """Ends with `code` and one sentence that holds all `words`."""
        assert self.code == code, (self.code, self.out, self.err)
        (line,) = self.err.splitlines()
        assert line.startswith("voxid: ")
        for word in words:
            assert str(word) in line, line


@pytest.fixture(scope="session")
def program():
    build = pathlib.Path(os.environ.get("VOXID_BUILD", "build"))
    path = ROOT / os.environ.get("VOXID", build / "bin" / "voxid")
    if not path.exists():
        pytest.fail(f"{path} is not there; scripts/build makes it")
    return path


@pytest.fixture(scope="session")
def voxid(program):
    def run(*arguments, timeout=120):
        command = [str(program), *map(str, arguments)]
        return Answer(subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=timeout))

    return run


@pytest.fixture(scope="session")
def models(tmp_path_factory):
    """Six categories, seven models: a folder a category, a PLY file a model."""
    folder = tmp_path_factory.mktemp("models")
    solids.write_ply(folder / "ball" / "ball_a.ply", solids.ball())
    solids.write_ply(folder / "board" / "board_a.ply", solids.box(1.0, 0.8, 0.04))
    solids.write_ply(folder / "cone" / "cone_a.ply", solids.turned([(0.0, 0.0), (0.5, 0.0), (0.0, 1.2)]))
    solids.write_ply(folder / "cube" / "cube_a.ply", solids.box(1.0, 1.0, 1.0))
    solids.write_ply(folder / "cube" / "cube_b.ply", solids.box(1.0, 0.9, 0.8))
    solids.write_ply(folder / "rod" / "rod_a.ply", solids.turned([(0.0, 0.0), (0.05, 0.0), (0.05, 1.5), (0.0, 1.5)]))
    solids.write_ply(folder / "tin" / "tin_a.ply", solids.turned([(0.0, 0.0), (0.4, 0.0), (0.4, 1.0), (0.0, 1.0)]))
    return folder


@pytest.fixture(scope="session")
def index(voxid, models, tmp_path_factory):
    path = tmp_path_factory.mktemp("index") / "solids.vxi"
    answer = voxid("build", "--models", models, "--out", path, "--jobs", 2)
    assert answer.code == 0, answer.err
    return path


@pytest.fixture(scope="session")
def paper_index(voxid, models, tmp_path_factory):
    path = tmp_path_factory.mktemp("paper_index") / "solids.vxi"
    answer = voxid("build", "--models", models, "--out", path, "--descriptor", "paper", "--jobs", 2)
    assert answer.code == 0, answer.err
    return path


@pytest.fixture(scope="session")
def views(voxid, models, tmp_path_factory):
    """Depth images of taught models, by model and direction, with their camera_info.yaml."""
    folder = tmp_path_factory.mktemp("views")

    def render(category, model, direction):
        out = folder / f"{model}_{direction}"
        if not out.exists():
            answer = voxid("render", models / category / f"{model}.ply", "--view", direction, "--out", out)
            assert answer.code == 0, answer.err
        (image,) = out.glob("*.png")
        return image

    return render


@pytest.fixture(scope="session")
def queries(views, tmp_path_factory):
    """Five taught views with their right labels, and one that is called what no index knows."""
    folder = tmp_path_factory.mktemp("queries")
    rows = ["file,category,model,points"]
    for category, model, direction in [*QUERIES, ("ball", "ball_a", 0)]:
        image = views(category, model, direction)
        name = f"{category}/{model}_{direction}.png"
        (folder / category).mkdir(exist_ok=True)
        (folder / name).write_bytes(image.read_bytes())
        (folder / "camera_info.yaml").write_bytes((image.parent / "camera_info.yaml").read_bytes())
        rows.append(f"{name},{'moon' if category == 'ball' else category},{model},1")
    (folder / "queries.csv").write_text("\n".join(rows) + "\n")
    return folder


@pytest.fixture(scope="session")
def scene(voxid, models, tmp_path_factory):
    """A table with a cube and a tin on it."""
    folder = tmp_path_factory.mktemp("scene")
    meshes = [models / "cube" / "cube_a.ply", models / "tin" / "tin_a.ply"]
    answer = voxid("render", "--table", "--models", *meshes, "--sizes", 12, "--out", folder)
    assert answer.code == 0, answer.err
    (image,) = folder.glob("*.png")
    return image


@pytest.fixture(scope="session")
def put_labelled_table(voxid, models, tmp_path_factory):
    """Puts a table with a cube and a tin into a folder, as each of the scenes NAMES: objects 2 and 3 of its labels."""
    made = tmp_path_factory.mktemp("made")
    meshes = [models / "cube" / "cube_a.ply", models / "tin" / "tin_a.ply"]
    answer = voxid("render", "--table", "--models", *meshes, "--sizes", 12, "--out", made,
                   "--labels", made / "labels.png")
    assert answer.code == 0, answer.err
    depth = cv2.imread(str(made / "frame_0000.png"), cv2.IMREAD_UNCHANGED)
    seen = cv2.imread(str(made / "labels.png"), cv2.IMREAD_UNCHANGED).astype(np.uint16)
    labels = np.where(seen > 0, 10 * (seen + 1), depth > 0).astype(np.uint16)

    def put(folder, *names):
        (folder / "camera_info.yaml").write_bytes((made / "camera_info.yaml").read_bytes())
        for name in names:
            assert cv2.imwrite(str(folder / f"{name}_depth.png"), depth)
            assert cv2.imwrite(str(folder / f"{name}_labels.png"), labels)

    return put


@pytest.fixture
def depth_file(tmp_path):
    """Writes pixels (uint16 mm or float32 m) as NAME.png or NAME.tiff beside a Kinect's camera_info.yaml."""

    def write(name, pixels):
        path = tmp_path / name
        assert cv2.imwrite(str(path), pixels)
        height, width = pixels.shape[:2]
        (tmp_path / "camera_info.yaml").write_text(
            f"image_width: {width}\nimage_height: {height}\n"
            f"camera_matrix: {{rows: 3, cols: 3, data: [525.0, 0.0, 319.5, 0.0, 525.0, 239.5, 0.0, 0.0, 1.0]}}\n")
        return path

    return write


@pytest.fixture(scope="session")
def slab():
    """A tilted plate, 100 x 80 pixels, as 16-bit millimetres."""
    pixels = np.zeros((480, 640), np.uint16)
    u = np.arange(100)
    pixels[200:280, 300:400] = 800 + u[None, :] + 2 * np.arange(80)[:, None]
    return pixels
