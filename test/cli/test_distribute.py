# SPDX-License-Identifier: BSD-3-Clause
"""voxid build over Dask: the same bytes, also when a worker is killed on the way; one line where it cannot be done."""
import json
import os
import pathlib
import shutil
import signal
import socket
import subprocess
import sys
import time

import pytest

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
        self.scheduler = self._start("scheduler", "--host", "127.0.0.1", "--port", self.address.rsplit(":", 1)[1],
                                     "--no-dashboard")
        for _ in range(workers):
            self.start_worker()

    def start_worker(self):
        return self._start("worker", self.address, "--nthreads", "1", "--no-nanny", "--no-dashboard", "--host",
                           "127.0.0.1", "--local-directory", str(self._folder / f"worker{len(self.processes)}"))

    def _start(self, *words):
        with open(self._folder / f"{len(self.processes)}.log", "w") as log:
            self.processes.append(subprocess.Popen(["/usr/bin/python3", "-m", "dask", *words], stdout=log, stderr=log,
                                                   cwd=self._folder))
        return self.processes[-1]

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
    left = pathlib.Path(f"{out}.parts/added.vxi.parts/0123.shard")  # by `voxid add` that was killed
    left.parent.mkdir(parents=True)
    left.write_text("half of it")
    answer = voxid("build", "--models", models, "--out", out, "--workers", 2, "--json")
    assert answer.code == 0, answer.err
    assert out.read_bytes() == expected
    assert answer.lines[-1]["models"] == 7 and answer.err == ""
    assert [path.name for path in out.parent.iterdir()] == ["index.vxi"]


def test_surfaces_are_kept_over_a_cluster_as_by_one_process(voxid, models, out, tmp_path):
    options = ("--models", models, "--views-every", 16, "--keep-points")
    assert voxid("build", *options, "--out", tmp_path / "one.vxi", "--jobs", 1).code == 0
    answer = voxid("build", *options, "--out", out, "--workers", 2)
    assert answer.code == 0, answer.err
    assert out.read_bytes() == (tmp_path / "one.vxi").read_bytes()
    assert voxid("info", out, "--json").json["surfaces"] == 7


class Build:
    """`voxid build --scheduler` under way, one model a task, so that there is a way to be killed on."""

    def __init__(self, models, out, cluster):
        words = ["--models", str(models), "--out", str(out), "--views-every", "1", "--descriptor", "default",
                 "--scheduler", cluster.address, "--json"]
        script = (f"import sys; sys.argv[1:] = {[str(PROGRAM), 'build', *words]!r}; from voxid import distribute; "
                  "distribute.MODELS_A_TASK = 1; import voxid_command; sys.exit(voxid_command.main())")
        self._out = out
        self.process = subprocess.Popen(["/usr/bin/python3", "-B", "-c", script], stdout=subprocess.PIPE,
                                        stderr=subprocess.PIPE, text=True,
                                        env={**os.environ, "PYTHONPATH": str(PROGRAM.parents[1] / "python")})

    def wait_for_models(self, count):
        parts, deadline = pathlib.Path(f"{self._out}.parts"), time.time() + 60
        while len(list(parts.glob("*.shard"))) < count and self.process.poll() is None and time.time() < deadline:
            time.sleep(0.005)
        assert self.process.poll() is None, self.process.communicate()

    def receipts(self):
        """Those of a build that ended well."""
        output, error = self.process.communicate(timeout=120)
        assert self.process.returncode == 0, error
        events = [json.loads(line) for line in output.splitlines()]
        return [event for event in events if event["event"] == "part"]


def test_a_worker_killed_on_the_way_costs_its_models_once_more(models, out, expected, cluster):
    build = Build(models, out, cluster)
    build.wait_for_models(2)
    cluster.processes[1].kill()
    receipts = build.receipts()
    assert out.read_bytes() == expected
    assert sum(receipt["models"] for receipt in receipts) == 7
    assert len(receipts) == len({receipt["part"] for receipt in receipts})


def is_at_work(worker):
    return any(path.read_text() for path in pathlib.Path(f"/proc/{worker.pid}/task").glob("*/children"))


def test_a_worker_that_comes_later_takes_tasks_from_the_busy_one(models, out, expected, tmp_path):
    cluster = Cluster(tmp_path, 1)
    try:
        build = Build(models, out, cluster)
        build.wait_for_models(1)
        second, took = cluster.start_worker(), False
        while build.process.poll() is None and not took:
            took = is_at_work(second)
            time.sleep(0.005)
        assert len(build.receipts()) == 7 and took
        assert out.read_bytes() == expected
    finally:
        cluster.stop()


def test_a_scheduler_that_ends_is_one_sentence(voxid, models, out, expected, cluster):
    build = Build(models, out, cluster)
    build.wait_for_models(1)
    cluster.scheduler.kill()
    error = build.process.communicate(timeout=60)[1]
    assert error == "voxid: the Dask scheduler is gone; what is finished waits for --resume\n"
    assert build.process.returncode == 1
    assert voxid("build", "--models", models, "--out", out, "--resume").code == 0
    assert out.read_bytes() == expected


def test_an_interrupt_ends_a_local_cluster_with_one_line(voxid, models, out, tmp_path):
    """As Ctrl-C sends it: to this process, Dask's and their children. Some seconds' work is left."""
    many = tmp_path / "many"
    for copy in range(8):
        shutil.copytree(models, many, dirs_exist_ok=True,
                        copy_function=lambda mesh, to: shutil.copy(mesh, to.replace(".", f"_{copy}.")))
    words = [PROGRAM, "build", "--models", many, "--out", out, "--workers", 2]
    # A shell's background jobs ignore interrupts, and so would what they start.
    build = subprocess.Popen([str(word) for word in words], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                             start_new_session=True, preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL))
    while not list(pathlib.Path(f"{out}.parts").glob("*.shard")) and build.poll() is None:
        time.sleep(0.005)
    os.killpg(build.pid, signal.SIGINT)
    assert build.communicate(timeout=60)[0] == "voxid: interrupted\n" and build.returncode == 1
    assert voxid("build", "--models", many, "--out", out, "--resume").code == 0


def test_what_goes_wrong_is_one_sentence(voxid, models, out, tmp_path):
    voxid("build", "--models", tmp_path / "absent", "--out", out, "--workers", 1).refuses(1, "absent")
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        address = f"tcp://127.0.0.1:{free.getsockname()[1]}"
    voxid("build", "--models", models, "--out", out, "--scheduler", address).refuses(1, address)
    voxid("build", "--models", models, "--out", out, "--scheduler", address, "--workers", 1).refuses(2, "--workers")
    for wrong in ("localhost", "tcp://localhost", "smoke://host:1"):
        voxid("build", "--models", models, "--out", out, "--scheduler", wrong).refuses(2, wrong, "tcp://HOST:PORT")
    (tmp_path / "empty" / "cube").mkdir(parents=True)
    voxid("build", "--models", tmp_path / "empty", "--out", out, "--workers", 1).refuses(3, "no mesh")


def test_a_part_that_cannot_be_made_is_a_sentence_and_its_code(models, out, tmp_path):
    (tmp_path / "damaged").mkdir()
    (tmp_path / "damaged" / "library.json").write_text("[]")
    words, settings = distribute.child_words(), {"models": str(models), "out": str(out)}
    for child, wrong, part, code, sentence in [(["/absent/python3"], {}, 0, 1, "/absent/python3 on"),
                                               (["/bin/sh", "-c", "echo gone >&2; kill -9 $$"], {}, 0, 1, "gone"),
                                               (words, {}, 2, 2, "no such part"),
                                               (words, {"models": "/absent"}, 0, 1, "/absent: No such"),
                                               (words, {"models": str(tmp_path / "damaged")}, 0, 4, "library.json")]:
        receipt = distribute.build_part(child, {**settings, **wrong}, part, 2)
        assert receipt["code"] == code and sentence in receipt["failure"], receipt


def test_tasks_are_of_some_models_each(models):
    assert distribute.tasks_for(models) == 1
