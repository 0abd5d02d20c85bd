# SPDX-License-Identifier: BSD-3-Clause
"""voxid build --workers N | --scheduler tcp://host:8786: models spread over Dask's workers (doc/scaling.md).

A task is one `voxid build --part K/N` on a worker; it leaves finished models in OUT.parts, on storage that all see, and
gives a receipt back. When all are there, `voxid build --resume` reads them one after another and writes the index: the
same bytes as of a build that did everything itself."""
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
import signal
import socket
import subprocess
import sys
import time

from voxid.acquire.parser import Parser
from voxid.failure import BAD_USE, CANNOT_DO, Failure

MODELS_A_TASK = 8  # some seconds of work, so that a worker that dies costs little and a task's own cost is small
MOST_TASKS = 20000
DEATHS = 5  # of workers at the same task, after which it is given up
CANCELLED = (asyncio.CancelledError, concurrent.futures.CancelledError)  # what tasks end with whose scheduler is gone


def options_of(arguments):
    parser = Parser(prog="voxid build", add_help=False)
    for name in ("--models", "--out", "--views-every", "--descriptor", "--projection", "--pairs", "--scheduler"):
        parser.add_argument(name)
    parser.add_argument("--workers", type=int)
    parser.add_argument("--keep-points", action="store_true")
    parser.add_argument("--resume", action="store_true")
    parser.add_argument("--json", action="store_true")
    return parser.parse_args(arguments)


def words_of(options):
    """The command line of a build that does the same, by full paths: workers stand in other folders."""
    words = ["--models", os.path.abspath(options.models), "--out", os.path.abspath(options.out),
             "--views-every", options.views_every, "--descriptor", options.descriptor]
    words += ["--keep-points"] if options.keep_points else []
    words += ["--projection", os.path.abspath(options.projection)] if options.projection else []
    return words + (["--pairs", options.pairs] if options.pairs else [])


def build_part(program, words, part):
    """On a worker: a receipt. It ends with its worker, so that nobody works on what another has been given."""
    library = ctypes.CDLL(None)
    try:
        done = subprocess.run([program, "build", *words, "--part", part, "--jobs", "1", "--json"],
                              stdin=subprocess.DEVNULL, capture_output=True, text=True,
                              preexec_fn=lambda: library.prctl(1, int(signal.SIGKILL)))
    except OSError as error:
        return {"part": part, "failure": f"{program} on {socket.gethostname()}: {error.strerror}", "code": CANNOT_DO}
    if done.returncode != 0:
        lines = done.stderr.strip().splitlines() or [f"part {part} ended with {done.returncode}"]
        return {"part": part, "failure": lines[-1], "code": done.returncode}
    last = json.loads(done.stdout.splitlines()[-1])
    return {"part": part, "models": last["models"], "views": last["views"], "skipped": last["skipped"]}


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
            if path.name != "lock":
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
    cloudpickle.register_pickle_by_value(sys.modules[__name__])  # workers need Dask and the program, not this package
    return distributed


def local_cluster(distributed, workers):
    return distributed.LocalCluster(n_workers=workers, threads_per_worker=1, processes=True, host="127.0.0.1",
                                    dashboard_address="127.0.0.1:0", silence_logs=logging.CRITICAL)


@contextlib.contextmanager
def client_of(options):
    with contextlib.ExitStack() as stack:
        try:
            with interrupts_held_back():
                distributed = load_dask()
                where = options.scheduler or stack.enter_context(local_cluster(distributed, options.workers))
            client = stack.enter_context(distributed.Client(where, set_as_default=False))
        except (OSError, ValueError) as error:
            raise Failure(f"no Dask scheduler answers at {options.scheduler or 'this machine'}: {error}",
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
        line = (f"{self._done} of {self._parts} parts, {self._models} models, {self._views / seconds:.0f} views/s, "
                f"{left_s // 60}:{left_s % 60:02} left, {self._skipped} skipped")
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
        code = receipt["code"] if receipt["code"] > 0 else CANNOT_DO
        raise Failure(receipt["failure"].removeprefix("voxid: "), code)
    return receipt


def collect(options, client, program, words, parts):
    """Waits for all receipts; the first refusal ends it."""
    from distributed import as_completed
    futures = [client.submit(build_part, program, words, f"{part}/{parts}", pure=False) for part in range(parts)]
    progress = Progress(parts, options.json)
    try:
        for future in as_completed(futures, loop=client.loop):
            progress.add(receipt_of(future))
    except (*CANCELLED, OSError):
        raise Failure("the Dask scheduler is gone; what is finished waits for --resume", CANNOT_DO) from None


def run(program, arguments):
    options = options_of(arguments)
    if options.scheduler and not re.fullmatch(r"(tcp|tls|wss?)://[^/\s]+:\d{1,5}", options.scheduler):
        raise Failure(f"--scheduler {options.scheduler}: expected tcp://HOST:PORT", BAD_USE)
    if not os.path.isdir(options.models):
        raise Failure(f"{options.models}: No such file or directory", CANNOT_DO)
    words = words_of(options)
    with locked_parts(options.out, options.resume), stderr_of_our_own(), client_of(options) as client:
        collect(options, client, program, words, tasks_for(options.models))
    sys.stdout.flush()
    more = ["--json"] if options.json else []
    os.execv(program, [program, "build", *words, "--resume", *more])
