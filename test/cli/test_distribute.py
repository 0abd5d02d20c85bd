# SPDX-License-Identifier: BSD-3-Clause
"""voxid build over Dask: the same bytes, also when a worker is killed on the way."""
import json
import os
import pathlib
import signal
import socket
import subprocess
import sys
import time

import pytest

pytest.importorskip("distributed")
ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = ROOT / os.environ.get("VOXID", pathlib.Path(os.environ.get("VOXID_BUILD", "build")) / "bin" / "voxid")
sys.path.insert(0, str(ROOT / "python"))
from voxid import distribute  # noqa: E402


@pytest.fixture(scope="module")
def expected(voxid, models, tmp_path_factory):
    path = tmp_path_factory.mktemp("expected") / "index.vxi"
    assert voxid("build", "--models", models, "--out", path, "--jobs", 2).code == 0
    return path.read_bytes()


@pytest.fixture
def out(tmp_path):
    (tmp_path / "out").mkdir()
    return tmp_path / "out" / "index.vxi"


class Cluster:
    """A scheduler and workers as processes of their own, on loopback."""

    def __init__(self, folder, workers):
        self._folder, self.processes = folder, []
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self.address = f"tcp://127.0.0.1:{free.getsockname()[1]}"
        self._start("scheduler", "--host", "127.0.0.1", "--port", self.address.rsplit(":", 1)[1], "--no-dashboard")
        for number in range(workers):
            self._start("worker", self.address, "--nthreads", "1", "--no-nanny", "--no-dashboard",
                        "--host", "127.0.0.1", "--local-directory", str(folder / f"worker{number}"))

    def _start(self, *words):
        with open(self._folder / f"{len(self.processes)}.log", "w") as log:
            self.processes.append(subprocess.Popen(["/usr/bin/python3", "-m", "dask", *words], stdout=log, stderr=log,
                                                   cwd=self._folder))

    def stop(self):
        for process in reversed(self.processes):
            process.kill()
            process.wait()


@pytest.fixture
def cluster(tmp_path):
    started = Cluster(tmp_path, 2)
    yield started
    started.stop()


def test_parts_of_two_processes_make_the_index(voxid, models, out, expected):
    for part in ("0/2", "1/2"):
        answer = voxid("build", "--models", models, "--out", out, "--part", part, "--json")
        assert answer.code == 0, answer.err
    assert not out.exists()
    shards = {path: path.stat().st_mtime_ns for path in pathlib.Path(f"{out}.parts").glob("*.shard")}
    assert len(shards) == 7
    assert voxid("build", "--models", models, "--out", out, "--resume").code == 0
    assert out.read_bytes() == expected
    voxid("build", "--models", models, "--out", out, "--part", "2/2").refuses(2, "--part 2/2")


def test_a_local_cluster_makes_the_same_bytes(voxid, models, out, expected):
    answer = voxid("build", "--models", models, "--out", out, "--workers", 2, "--json")
    assert answer.code == 0, answer.err
    assert out.read_bytes() == expected
    assert answer.lines[-1]["models"] == 7 and answer.err == ""
    assert [path.name for path in out.parent.iterdir()] == ["index.vxi"]


def test_a_worker_killed_on_the_way_costs_its_models_once_more(models, out, expected, cluster):
    """One model a task, so that there is a way to be killed on."""
    environment = {**os.environ, "PYTHONPATH": str(ROOT / "python")}
    script = ("from voxid import distribute; distribute.MODELS_A_TASK = 1; "
              f"distribute.run({str(PROGRAM)!r}, {arguments(models, out, cluster)!r})")
    build = subprocess.Popen(["/usr/bin/python3", "-B", "-c", script], env=environment, stdout=subprocess.PIPE,
                             stderr=subprocess.PIPE, text=True)
    parts, deadline = pathlib.Path(f"{out}.parts"), time.time() + 60
    while len(list(parts.glob("*.shard"))) < 2 and build.poll() is None and time.time() < deadline:
        time.sleep(0.005)
    cluster.processes[1].send_signal(signal.SIGKILL)
    assert build.poll() is None, build.communicate()
    output, error = build.communicate(timeout=120)
    assert build.returncode == 0, error
    assert out.read_bytes() == expected
    events = [json.loads(line) for line in output.splitlines()]
    receipts = [event for event in events if event["event"] == "part"]
    assert sum(receipt["models"] for receipt in receipts) == 7
    assert len(receipts) == len({receipt["part"] for receipt in receipts})


def arguments(models, out, cluster):
    return ["--models", str(models), "--out", str(out), "--views-every", "1", "--descriptor", "default",
            "--scheduler", cluster.address, "--json"]


def test_what_goes_wrong_is_one_sentence(voxid, models, out, tmp_path):
    voxid("build", "--models", tmp_path / "absent", "--out", out, "--workers", 1).refuses(1, "absent")
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        address = f"tcp://127.0.0.1:{free.getsockname()[1]}"
    voxid("build", "--models", models, "--out", out, "--scheduler", address).refuses(1, address)
    voxid("build", "--models", models, "--out", out, "--scheduler", address, "--workers", 1).refuses(2, "--workers")
    (tmp_path / "empty" / "cube").mkdir(parents=True)
    voxid("build", "--models", tmp_path / "empty", "--out", out, "--workers", 1).refuses(3, "no mesh")


def test_tasks_are_of_some_models_each(models):
    assert distribute.tasks_for(models) == 1
