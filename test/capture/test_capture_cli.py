# SPDX-License-Identifier: BSD-3-Clause
"""voxid capture list|record on a folder that the replay driver plays."""
import json
import os
import pathlib
import signal
import subprocess
import time

import numpy as np
import cv2
import pytest

BUILD = pathlib.Path(os.environ.get("VOXID_BUILD", "build")).resolve()
VOXID = BUILD / "bin" / "voxid"


@pytest.fixture
def folder(tmp_path):
    path = tmp_path / "frames"
    path.mkdir()
    for i in range(3):
        image = np.random.default_rng(i).integers(500, 2000, (60, 80), np.uint16)  # some kilobytes in a recording
        cv2.imwrite(str(path / f"f{i}_depth.png"), image)
    return path


def await_frames(out):
    """Until the unfinished recording of that name holds some frames."""
    for _ in range(600):
        if sum(p.stat().st_size for p in out.parent.glob(out.name + ".part-*")) > 40000:
            return
        time.sleep(0.05)
    pytest.fail("nothing is being recorded")


def environment(folder=None, **options):
    """What scripts/replay_env.sh prints, as a program takes it."""
    env = {k: v for k, v in os.environ.items() if not k.startswith("VOXID_REPLAY")}
    env["VOXID_BUILD"] = str(BUILD)
    if folder is None:
        return {**env, "LD_LIBRARY_PATH": f"{BUILD}/openni2:{env.get('LD_LIBRARY_PATH', '')}"}
    arguments = [f"{k}={v}" for k, v in options.items()]
    script = 'set -e; text=$(scripts/replay_env.sh "$@"); eval "$text"; env -0'
    out = subprocess.run(["bash", "-c", script, "-", str(folder), *arguments], env=env, check=True,
                         capture_output=True).stdout
    return dict(line.split("=", 1) for line in out.decode().split("\0") if line)


def run(env, *arguments):
    return subprocess.run([VOXID, "capture", *arguments], env=env, capture_output=True, text=True, timeout=60)


def test_list_shows_the_folder(folder):
    done = run(environment(folder, serial="S1"), "list", "--json")
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout) == [{"uri": f"replay:{folder}", "vendor": "voxid", "name": "Replay", "serial": "S1"}]
    assert run(environment(folder, serial="S1"), "list").stdout == f"#1  voxid Replay  serial S1  replay:{folder}\n"


def test_list_without_a_device(tmp_path):
    done = run(environment(), "list", "--json")
    assert done.returncode == 1
    assert json.loads(done.stdout) == []
    assert done.stderr == "voxid: no device: OpenNI2 sees no device; check the cable and the udev rules\n"


def test_a_replay_that_is_not_there(tmp_path):
    done = run({**environment(), "VOXID_REPLAY": str(tmp_path)}, "list")
    assert done.returncode == 1
    assert done.stderr.endswith(
        f"voxid: no device: OpenNI2 sees no device, nor the replay of {tmp_path}; does the folder hold depth images, "
        "and LD_LIBRARY_PATH begin with the replay driver's folder?\n")


def test_an_option_that_is_not_understood_is_said(folder):
    done = run(environment(folder, fps="0.5"), "list")
    assert done.returncode == 0
    assert done.stderr.startswith("voxid replay: environment: 'fps=0.5' is not understood; expected fps=1..1000")


def test_record_and_play_the_recording_as_a_device(folder, tmp_path):
    out = tmp_path / "x.oni"
    done = run(environment(folder), "record", "--out", str(out), "--frames", "5", "--json")
    assert done.returncode == 0, done.stderr
    report = json.loads(done.stdout)
    assert report["frames"] >= 5 and report["file"] == str(out)
    again = tmp_path / "y.oni"
    done = run(environment(), "record", "--device", str(out), "--out", str(again), "--json")
    assert done.returncode == 0, done.stderr
    assert [p.name for p in sorted(tmp_path.iterdir())] == ["frames", "x.oni", "y.oni"]


def test_record_for_a_time(folder, tmp_path):
    done = run(environment(folder), "record", "--out", str(tmp_path / "x.oni"), "--seconds", "0.5")
    assert done.returncode == 0, done.stderr
    assert "frames in 0." in done.stdout


def test_interrupt_finishes_the_file(folder, tmp_path):
    out = tmp_path / "x.oni"
    process = subprocess.Popen([VOXID, "capture", "record", "--out", str(out)], env=environment(folder),
                               stdout=subprocess.PIPE, text=True)
    await_frames(out)
    process.send_signal(signal.SIGINT)
    assert process.wait(timeout=30) == 0
    assert "frames in" in process.stdout.read()
    assert out.exists() and len(list(tmp_path.iterdir())) == 2


NOTHING_SEEN = "OpenNI2 sees no device; check the cable and the udev rules"


@pytest.mark.parametrize("arguments, sentence", [
    ([], f"voxid: no device: {NOTHING_SEEN}\n"),
    (["--device", "#2"], f"voxid: no device #2: {NOTHING_SEEN}\n"),
    (["--device", "B007"], f"voxid: no device with URI or serial number 'B007': {NOTHING_SEEN}\n"),
    (["--device", "no.oni"], "voxid: no.oni does not exist; expected an .oni recording\n"),
])
def test_record_without_a_device(tmp_path, arguments, sentence):
    done = run(environment(), "record", "--out", str(tmp_path / "x.oni"), *arguments)
    assert (done.returncode, done.stderr) == (1, sentence)
    assert not list(tmp_path.iterdir())


def test_bad_use_and_damage(folder, tmp_path):
    env = environment(folder)
    assert run(env, "record").returncode == 2
    assert run(env).returncode == 2
    assert run(env, "record", "--out", str(tmp_path / "x.oni"), "--device", "#x").returncode == 2
    assert run(env, "record", "--out", str(tmp_path / "no" / "x.oni"), "--frames", "1").returncode == 1
    cut = tmp_path / "cut.oni"
    cut.write_bytes(b"NI10" + bytes(40))
    done = run(env, "record", "--device", str(cut), "--out", str(tmp_path / "x.oni"))
    assert done.returncode == 4
    assert done.stderr.count("\n") == 1 and "is cut short" in done.stderr


def test_a_device_that_vanishes_leaves_what_came(folder, tmp_path):
    control = tmp_path / "control"
    control.touch()
    out = tmp_path / "x.oni"
    process = subprocess.Popen([VOXID, "capture", "record", "--out", str(out)],
                               env=environment(folder, control=control),
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    await_frames(out)
    control.write_text("unplug\n")
    assert process.wait(timeout=30) == 1
    assert "vanished after" in process.stderr.read()
    assert out.exists()
