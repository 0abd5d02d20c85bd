# SPDX-License-Identifier: BSD-3-Clause
"""voxid render: depth images with known truth."""
import cv2
import numpy as np

import solids


def read(path):
    image = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
    assert image.dtype == np.uint16 and image.shape == (480, 640)
    return image


def test_all_views_of_a_model(voxid, models, tmp_path):
    assert voxid("render", models / "cube" / "cube_a.ply", "--all", "--out", tmp_path).code == 0
    assert sorted(path.name for path in tmp_path.glob("*.png")) == [f"cube_a_{view:02d}.png" for view in range(80)]
    assert (tmp_path / "camera_info.yaml").exists()
    for view in (0, 17, 79):
        depth = read(tmp_path / f"cube_a_{view:02d}.png")
        seen = depth[depth > 0]
        assert 400 < seen.size < 60000
        assert 400 < seen.min() and seen.max() < 1400


def test_the_seed_decides_and_nothing_else(voxid, models, tmp_path):
    def render(name, *options):
        assert voxid("render", models / "ball" / "ball_a.ply", "--view", 7, "--out", tmp_path / name,
                     *options).code == 0
        return (tmp_path / name / "ball_a_07.png").read_bytes()

    assert render("a", "--seed", 3) == render("b", "--seed", 3)
    assert render("c", "--seed", 4) != render("a", "--seed", 3)


def test_a_clean_ball_is_a_ball(voxid, models, tmp_path):
    """Every pixel's point lies on one sphere; the sensor's noise is some millimetres more."""
    def spread(*options):
        assert voxid("render", models / "ball" / "ball_a.ply", "--view", 3, "--out", tmp_path, *options).code == 0
        depth = read(tmp_path / "ball_a_03.png").astype(float)
        v, u = np.nonzero(depth)
        z = depth[v, u]
        points = np.stack([(u - 319.5) * z / 525, (v - 239.5) * z / 525, z], axis=1)
        # |p|^2 = 2 p.c + (r^2 - |c|^2): linear in the centre and the constant.
        solution = np.linalg.lstsq(np.c_[2 * points, np.ones(len(z))], (points ** 2).sum(axis=1), rcond=None)[0]
        radius = np.sqrt(solution[3] + (solution[:3] ** 2).sum())
        return np.abs(np.linalg.norm(points - solution[:3], axis=1) - radius).mean()

    assert spread("--clean") < 0.5
    assert 0.5 < spread() < 4


def test_a_table_with_models_and_its_truth(voxid, models, tmp_path):
    out, labels = tmp_path / "frames", tmp_path / "labels"
    meshes = [models / "cube" / "cube_a.ply", models / "tin" / "tin_a.ply", models / "ball" / "ball_a.ply"]
    answer = voxid("render", "--table", "--models", *meshes, "--sizes", 10, 14, 12, "--frames", 2, "--labels", labels,
                   "--out", out)
    assert answer.code == 0, answer.err
    names = ["frame_0000.png", "frame_0001.png"]
    assert [sorted(path.name for path in folder.glob("*.png")) for folder in (out, labels)] == [names, names]
    first, second = (read(out / name) for name in names)
    truth = read(labels / names[0])
    assert set(np.unique(truth)) == {0, 1, 2, 3}
    assert (first[truth > 0] > 0).all()
    assert (first != second).any() and abs(int((first > 0).sum()) - int((second > 0).sum())) < 3000
    assert (first > 0).sum() > 100000  # the table

    scene = voxid("segment", out / names[0], "--json").json
    assert scene["status"] == "OK" and len(scene["objects"]) == 3
    for found in scene["objects"]:
        x, y, width, height = found["box_px"]
        inside = truth[y:y + height, x:x + width]
        assert found["pixels"] > 0.8 * max((inside == label).sum() for label in (1, 2, 3))


def test_the_truth_is_not_written_over_the_frames(voxid, models, tmp_path):
    table = ("render", "--table", "--models", models / "cube" / "cube_a.ply", "--sizes", 10)
    for out, labels in ((tmp_path, tmp_path / "."), (tmp_path / "x.png", tmp_path / "x.png"),
                        (tmp_path / "frame_0000.png", tmp_path)):
        voxid(*table, "--out", out, "--labels", labels).refuses(2, "--labels", labels)
    assert not list(tmp_path.iterdir())


def test_bad_use(voxid, models, tmp_path):
    cube = models / "cube" / "cube_a.ply"
    voxid("render", "--out", tmp_path).refuses(2, "which mesh")
    voxid("render", tmp_path / "absent.ply", "--out", tmp_path).refuses(1, "absent.ply")
    voxid("render", cube, "--view", 80, "--out", tmp_path).refuses(2, "--view")
    voxid("render", "--table", "--models", cube, "--out", tmp_path).refuses(2, "cube_a.ply", "--sizes")
    voxid("render", "--table", "--models", cube, cube, "--sizes", 10, 10, 10, "--out", tmp_path).refuses(2, "--sizes")
    voxid("render", "--table", "--models", cube, "--sizes", "nan", "--out", tmp_path).refuses(2, "--sizes", "nan")
    voxid("render", "--table", "--models", *[cube] * 9, "--sizes", 30, "--out", tmp_path).refuses(2, "room")
    voxid("render", cube, "--out", cube / "x").refuses(1, "x")


def test_a_mesh_without_a_triangle_is_refused(voxid, tmp_path):
    solids.write_ply(tmp_path / "points.ply", ([(0, 0, 0), (1, 0, 0)], []))
    voxid("render", tmp_path / "points.ply", "--out", tmp_path).refuses(3, "no triangle")
