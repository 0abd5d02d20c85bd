# SPDX-License-Identifier: BSD-3-Clause
"""Wrong input gives one sentence and its exit code, never a traceback."""
import os
import pathlib
import struct
import subprocess

import cv2
import numpy as np
import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = ROOT / os.environ.get("VOXID", pathlib.Path(os.environ.get("VOXID_BUILD", "build")) / "bin" / "voxid")
MAJOR_AT = 8


@pytest.fixture
def image(depth_file, slab):
    return depth_file("slab.png", slab)


def classify(voxid, image, index, *options):
    return voxid("classify", image, "--index", index, *options)


def crc32c(data):
    table = []
    for byte in range(256):
        for _ in range(8):
            byte = byte >> 1 ^ (0x82F63B78 if byte & 1 else 0)
        table.append(byte)
    crc = 0xFFFFFFFF
    for byte in data:
        crc = crc >> 8 ^ table[(crc ^ byte) & 0xFF]
    return crc ^ 0xFFFFFFFF


def test_arguments(voxid, image, index):
    voxid().refuses(2)
    voxid("guess").refuses(2, "guess")
    voxid("classify").refuses(2, "--help")
    voxid("classify", image).refuses(2, "--index")
    classify(voxid, image, index, "--radius", 53).refuses(2, "--radius")
    classify(voxid, image, index, "--radius", 3, "--exact").refuses(2, "--exact")
    classify(voxid, image, index, "--vote", "--1nn").refuses(2, "--vote")
    classify(voxid, image, index, "--min-score", 1.5).refuses(2, "--min-score")
    classify(voxid, image, index, "--min-score", "nan").refuses(2, "--min-score", "nan")
    voxid("eval", "--index", index, "--queries", ".", "--jobs", 0).refuses(2, "--jobs")


@pytest.mark.parametrize("command", [[], ["bench"], ["build"], ["capture"], ["classify"], ["describe"], ["eval"],
                                     ["info"], ["render"], ["segment"], ["verify"]])
def test_help_is_everywhere(voxid, command):
    answer = voxid(*command, "--help")
    assert answer.code == 0 and "Usage:" in answer.out and answer.err == ""


def test_a_pipe_is_no_index(voxid, tmp_path):
    """Nobody writes to it: it must not be waited for."""
    os.mkfifo(tmp_path / "pipe.vxi")
    voxid("info", tmp_path / "pipe.vxi", timeout=20).refuses(1, "pipe.vxi", "not a regular file")


def test_version(voxid):
    answer = voxid("--version")
    assert answer.code == 0 and answer.out.startswith("voxid ") and answer.out.count(".") == 2


def test_index_missing_empty_or_something_else(voxid, image, tmp_path):
    classify(voxid, image, tmp_path / "none.vxi").refuses(1, "none.vxi")
    for command in ("info", "verify"):
        voxid(command, tmp_path / "none.vxi").refuses(1, "none.vxi")
        voxid(command, tmp_path).refuses(1, tmp_path)
    empty = tmp_path / "empty.vxi"
    empty.touch()
    classify(voxid, image, empty).refuses(4, "empty.vxi", "empty")
    voxid("verify", empty).refuses(4, "empty.vxi", "empty")
    text = tmp_path / "text.vxi"
    text.write_text("no index at all\n" * 100)
    answer = voxid("info", text)
    assert answer.code in (1, 4) and len(answer.err.splitlines()) == 1


def test_index_of_another_version(voxid, image, index, tmp_path):
    data = bytearray(index.read_bytes())
    struct.pack_into("<H", data, MAJOR_AT, 7)
    sections = struct.unpack_from("<I", data, 24)[0]
    struct.pack_into("<I", data, 48, 0)
    struct.pack_into("<I", data, 48, crc32c(bytes(data[:64 + 32 * sections])))
    other = tmp_path / "other.vxi"
    other.write_bytes(data)
    classify(voxid, image, other).refuses(1, "other.vxi", "7")
    voxid("verify", other).refuses(1, "7")


def test_a_cut_index_is_refused_at_opening(voxid, image, index, tmp_path):
    data = index.read_bytes()
    cut = tmp_path / "cut.vxi"
    for length in [1, 8, 63, 64, 100, len(data) // 2, len(data) - 1]:
        cut.write_bytes(data[:length])
        classify(voxid, image, cut).refuses(4, "cut.vxi")


def test_any_flipped_byte_is_found(voxid, index, tmp_path):
    data = index.read_bytes()
    flipped = tmp_path / "flipped.vxi"
    for at in [0, 9, 20, 50, 70, 200, *np.linspace(300, len(data) - 1, 8).astype(int)]:
        damaged = bytearray(data)
        damaged[at] ^= 0x10
        flipped.write_bytes(damaged)
        answer = voxid("verify", flipped)
        assert answer.code in ((1, 4) if at < 12 else (4,)), at
        assert len(answer.err.splitlines()) == 1 and answer.err.startswith("voxid: ")


def test_an_intact_index_is_ok(voxid, index):
    answer = voxid("verify", index)
    assert (answer.code, answer.err) == (0, "") and answer.out.strip().endswith("ok")


@pytest.mark.parametrize("command", ["classify", "describe", "segment"])
def test_images_that_are_no_depth(voxid, index, tmp_path, command):
    more = ["--index", index] if command == "classify" else []

    def refused(path, code, *words):
        voxid(command, path, *more).refuses(code, path, *words)

    def written(name, pixels):
        assert cv2.imwrite(str(tmp_path / name), pixels)
        return tmp_path / name

    refused(tmp_path / "none.png", 1, "no such file")
    refused(tmp_path, 1, "not a file")
    refused(written("grey.png", np.full((48, 64), 7, np.uint8)), 1, "8-bit", "16-bit")
    refused(written("colour.png", np.full((48, 64, 3), 7, np.uint8)), 1, "8-bit, 3 channels")
    refused(written("colour16.png", np.full((48, 64, 3), 7, np.uint16)), 1, "16-bit, 3 channels")
    refused(written("photo.jpg", np.full((48, 64, 3), 7, np.uint8)), 1, "8-bit, 3 channels")
    (tmp_path / "text.png").write_text("no image\n")
    refused(tmp_path / "text.png", 1, "depth image")
    (tmp_path / "empty.png").touch()
    refused(tmp_path / "empty.png", 4, "empty")


def test_a_cut_or_flipped_image_is_damaged(voxid, tmp_path, slab):
    whole = tmp_path / "whole.png"
    assert cv2.imwrite(str(whole), slab)
    data, bad = whole.read_bytes(), tmp_path / "bad.png"
    for length in [4, 8, 20, 33, len(data) // 2, len(data) - 12, len(data) - 1]:
        bad.write_bytes(data[:length])
        voxid("describe", bad).refuses(4, "bad.png", "damaged PNG")
    for at in [20, len(data) // 2]:
        flipped = bytearray(data)
        flipped[at] ^= 1
        bad.write_bytes(flipped)
        voxid("describe", bad).refuses(4, "bad.png", "checksum")
    tiff = tmp_path / "whole.tiff"
    assert cv2.imwrite(str(tiff), slab)
    for length in [4, 200, tiff.stat().st_size // 2]:
        (tmp_path / "bad.tiff").write_bytes(tiff.read_bytes()[:length])
        voxid("describe", tmp_path / "bad.tiff").refuses(4, "bad.tiff", "damaged TIFF")


def test_camera_as_text(voxid, image):
    for text in ["1,2,3", "a,b,c,d", "525,525,319.5,239.5,1", "none.yaml", "525 525 319.5 239.5"]:
        voxid("describe", image, "--camera", text).refuses(2, "--camera", text, "fx,fy,cx,cy")
    for text in ["0,525,319.5,239.5", "-525,525,319.5,239.5", "525,1e9,319.5,239.5"]:
        voxid("describe", image, "--camera", text).refuses(2, "--camera", "out of range")
    assert voxid("describe", image, "--camera", "525,525,319.5,239.5").code == 0


def test_camera_as_file(voxid, image, tmp_path):
    beside = image.parent / "camera_info.yaml"
    good = beside.read_text()
    for text in ["", "[1, 2", "image_width: 640\n", good.replace("camera_matrix", "matrix"),
                 good.replace("239.5, 0.0, 0.0, 1.0", "239.5"), good.replace("525.0", "wide"), "- 1\n- 2\n"]:
        beside.write_text(text)
        voxid("describe", image).refuses(1, "camera_info.yaml", "camera_matrix")
    beside.write_text(good.replace("image_width: 640", "image_width: 320"))
    voxid("describe", image).refuses(1, "camera_info.yaml", "320 x 480", "640 x 480")
    beside.write_text(good.replace("525.0", "0.0"))
    voxid("describe", image).refuses(1, "camera_info.yaml", "out of range")
    other = tmp_path / "other.yaml"
    other.write_text(good)
    assert voxid("describe", image, "--camera", other).code == 0


def test_the_assumed_camera_is_said_once(voxid, index, tmp_path, slab):
    paths = [tmp_path / name for name in ("a.png", "b.png")]
    for path in paths:
        assert cv2.imwrite(str(path), slab)
    answer = voxid("classify", *paths, "--index", index, "--json")
    assert answer.code == 0 and len(answer.lines) == 2
    (said,) = answer.err.splitlines()
    assert "525,525,319.5,239.5" in said


@pytest.mark.parametrize("command", [["info", "INDEX"], ["acquire", "mug"], ["--help"], ["--version"],
                                     ["build", "--help"], ["acquire", "--help"]])
def test_a_full_disk_under_standard_output_is_one_line(index, command):
    words = [str(PROGRAM), *(str(index) if word == "INDEX" else word for word in command)]
    with open("/dev/full", "w") as full:
        run = subprocess.run(words, stdout=full, stdin=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
                             timeout=60)
    assert run.returncode == 1 and len(run.stderr.splitlines()) == 1, run.stderr
    assert run.stderr.startswith("voxid: ") and "No space left on device" in run.stderr
