# SPDX-License-Identifier: BSD-3-Clause
"""voxid build --workers N | --scheduler tcp://host:8786: models spread over Dask's workers (doc/scaling.md).

A task is voxid.build(part=(k, n)) on a worker, in a process of its own (build_part.py); it leaves finished models in
OUT.parts, on storage that all see, and gives a receipt back. When all are there, `voxid build --resume` reads them one
after another and writes the index: the same bytes as of a build that did everything itself."""
import asyncio
import concurrent.futures
import contextlib
import ctypes
import fcntl
import json
import logging
import multiprocessing.resource_tracker
import os
import pathlib
import re
import shutil
import signal
import socket
import subprocess
import sys
import time

import voxid
from voxid.acquire.parser import Parser
from voxid.acquire.source import counted
from voxid.failure import BAD_USE, CANNOT_DO, Failure

MODELS_A_TASK = 8  # some seconds of work, so that a worker that dies costs little and a task's own cost is small
MOST_TASKS = 20000
DEATHS = 5  # of workers at the same task, after which it is given up
CANCELLED = (asyncio.CancelledError, concurrent.futures.CancelledError)  # what tasks end with whose scheduler is gone


def places_of(arguments):
    """Where and how it is to be done, and the arguments that say what: those of a build on one machine."""
    parser = Parser(prog="voxid build", add_help=False)
    parser.add_argument("--scheduler")
    parser.add_argument("--workers", type=int)
    parser.add_argument("--resume", action="store_true")
    parser.add_argument("--json", action="store_true")
    return parser.parse_known_args(arguments)


def settings_of(words):
    """The same as arguments of voxid.build(), by full paths: workers stand in other folders."""
    parser = Parser(prog="voxid build", add_help=False)
    for name in ("--models", "--out", "--projection"):
        parser.add_argument(name, type=os.path.abspath)
    parser.add_argument("--descriptor")
    parser.add_argument("--views-every", type=int)
    parser.add_argument("--pairs", type=int)
    parser.add_argument("--bytes", type=int, dest="code_bytes")
    parser.add_argument("--keep-points", action="store_true")
    return vars(parser.parse_args(words))


def child_words():
    """Starts build_part.py, on any machine that has voxid under the same path."""
    folders = [os.path.dirname(os.path.abspath(part)) for part in voxid.__path__]
    script = os.path.join(os.path.dirname(os.path.abspath(__file__)), "build_part.py")
    return [sys.executable, "-B", "-E", "-s", "-X", "utf8", script, *folders]


def build_part(words, settings, part, parts):
    """On a worker: a receipt. It ends with its worker, so that nobody works on what another has been given."""
    library = ctypes.CDLL(None)
    try:
        done = subprocess.run(words, input=json.dumps({**settings, "part": (part, parts)}), capture_output=True,
                              text=True, errors="replace", preexec_fn=lambda: library.prctl(1, int(signal.SIGKILL)))
    except OSError as error:
        return {"failure": f"{words[0]} on {socket.gethostname()}: {error.strerror}", "code": CANNOT_DO}
    if done.returncode != 0:
        lines = done.stderr.strip().splitlines() or [f"part {part}/{parts} ended with {done.returncode}"]
        return {"failure": f"{lines[-1]} (on {socket.gethostname()})", "code": CANNOT_DO}
    return {"part": f"{part}/{parts}", **json.loads(done.stdout)}


def tasks_for(models):
    """As many parts as make MODELS_A_TASK files each."""
    with os.scandir(models) as folders:
        names = [folder.path for folder in folders if folder.is_dir() and not folder.name.startswith(".")]
    files = sum(len(os.listdir(name)) for name in names)
    return max(1, min(MOST_TASKS, -(-files // MODELS_A_TASK)))


@contextlib.contextmanager
def locked_parts(out, resume):
    """OUT.parts, where other builds of the same index are kept out as long as the block lasts."""
    parts = pathlib.Path(f"{out}.parts")
    parts.mkdir(exist_ok=True)
    with open(parts / "lock", "w") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise Failure(f"another build of {out} is running; wait for it, or choose another name",
                          CANNOT_DO) from None
        for path in () if resume else parts.iterdir():
            if path.is_dir():  # of `voxid add` that was killed
                shutil.rmtree(path)
            elif path.name != "lock":
                path.unlink()
        yield


@contextlib.contextmanager
def interrupts_held_back():
    """Processes and threads that begin meanwhile never see one: Ctrl-C is for this process to answer."""
    multiprocessing.resource_tracker.ensure_running()  # as it starts it lets them through again
    signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})


@contextlib.contextmanager
def stderr_of_our_own():
    """What Dask's processes write there as they die is not heard."""
    ours, shared = sys.stderr, os.dup(2)
    with open(os.devnull, "w") as nowhere, open(shared, "w", buffering=1) as sys.stderr:
        os.dup2(nowhere.fileno(), 2)
        try:
            yield
        finally:
            os.dup2(shared, 2)
            sys.stderr = ours


def load_dask():
    try:
        import cloudpickle
        import dask
        import distributed
    except ImportError:
        raise Failure("Dask is not installed; scripts/install_deps installs python3-distributed", CANNOT_DO) from None
    dask.config.set({"distributed.scheduler.allowed-failures": DEATHS, "distributed.comm.timeouts.connect": "10s"})
    logging.disable()  # what goes wrong is said in one sentence below
    cloudpickle.register_pickle_by_value(sys.modules[__name__])  # this package is not on the path of workers
    return distributed


def local_cluster(distributed, workers):
    return distributed.LocalCluster(n_workers=workers, threads_per_worker=1, processes=True, host="127.0.0.1",
                                    dashboard_address="127.0.0.1:0", silence_logs=logging.CRITICAL)


@contextlib.contextmanager
def client_of(places):
    with contextlib.ExitStack() as stack:
        try:
            with interrupts_held_back():
                distributed = load_dask()
                where = places.scheduler or stack.enter_context(local_cluster(distributed, places.workers))
            client = stack.enter_context(distributed.Client(where, set_as_default=False))
        except (OSError, ValueError) as error:
            raise Failure(f"no Dask scheduler answers at {places.scheduler or 'this machine'}: {error}",
                          CANNOT_DO) from None
        yield client


class Progress:
    """Of receipts: an event each with --json, else one line on a terminal, redrawn in place, and nothing elsewhere."""

    def __init__(self, parts, as_json):
        self._parts, self._json, self._start = parts, as_json, time.monotonic()
        self._done = self._models = self._views = self._skipped = 0

    def add(self, receipt):
        self._done += 1
        self._models += receipt["models"]
        self._views += receipt["views"]
        self._skipped += len(receipt["skipped"])
        if self._json:
            print(json.dumps({"event": "part", **receipt}), flush=True)
        elif sys.stderr.isatty():
            self._draw()

    def _draw(self):
        seconds = time.monotonic() - self._start
        left_s = int(seconds * (self._parts - self._done) / self._done)
        line = (f"{self._done} of {self._parts} parts, {counted(self._models, 'model')}, "
                f"{self._views / seconds:.0f} views/s, {left_s // 60}:{left_s % 60:02} left, "
                f"{self._skipped} skipped")
        print(f"\r\033[K{line if self._done < self._parts else ''}", end="", file=sys.stderr, flush=True)


def receipt_of(future):
    """What its task gave; a Failure if that could not be done."""
    from distributed.scheduler import KilledWorker
    try:
        receipt = future.result()
    except KilledWorker:
        raise Failure(f"{DEATHS} workers died at the same models; what is finished waits for --resume",
                      CANNOT_DO) from None
    if "failure" in receipt:
        raise Failure(receipt["failure"], receipt["code"])
    return receipt


def collect(client, settings, parts, progress):
    """Waits for all receipts; the first refusal ends it."""
    from distributed import as_completed
    words = child_words()
    futures = [client.submit(build_part, words, settings, part, parts, pure=False) for part in range(parts)]
    try:
        for future in as_completed(futures, loop=client.loop):
            progress.add(receipt_of(future))
    except (*CANCELLED, OSError):
        raise Failure("the Dask scheduler is gone; what is finished waits for --resume", CANNOT_DO) from None


def check(places, models):
    if places.scheduler and not re.fullmatch(r"(tcp|tls|wss?)://[^/\s]+:\d{1,5}", places.scheduler):
        raise Failure(f"--scheduler {places.scheduler}: expected tcp://HOST:PORT", BAD_USE)
    if not os.path.isdir(models):
        raise Failure(f"{models}: No such file or directory", CANNOT_DO)
    try:
        voxid.build  # loaded here, so that it fails before there is a cluster
    except ImportError as error:
        raise Failure(error, CANNOT_DO) from None


def run(program, arguments):
    places, words = places_of(arguments)
    settings = settings_of(words)
    check(places, settings["models"])
    parts = tasks_for(settings["models"])
    with locked_parts(settings["out"], places.resume), stderr_of_our_own(), client_of(places) as client:
        collect(client, settings, parts, Progress(parts, places.json))
    sys.stdout.flush()
    os.execv(program, [program, "build", *words, "--resume", *(["--json"] if places.json else [])])
