# SPDX-License-Identifier: BSD-3-Clause
"""voxid build --workers N | --scheduler tcp://host:8786: models spread over Dask's workers (doc/scaling.md).

A task is one `voxid build --part K/N` on a worker; it leaves finished models in OUT.parts, on storage that all see, and
gives a receipt back. When all are there, `voxid build --resume` reads them one after another and writes the index: the
same bytes as of a build that did everything itself."""
import contextlib
import ctypes
import fcntl
import json
import logging
import os
import pathlib
import signal
import subprocess
import sys

from voxid.acquire.parser import Parser
from voxid.failure import CANNOT_DO, Failure

MODELS_A_TASK = 8  # some seconds of work, so that a worker that dies costs little and a task's own cost is small
MOST_TASKS = 20000
DEATHS = 5  # of workers at the same task, after which it is given up


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
    done = subprocess.run([program, "build", *words, "--part", part, "--jobs", "1", "--json"], stdin=subprocess.DEVNULL,
                          capture_output=True, text=True, preexec_fn=lambda: library.prctl(1, int(signal.SIGKILL)))
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
def client_of(options):
    try:
        import cloudpickle
        import dask
        import distributed
    except ImportError:
        raise Failure("Dask is not installed; scripts/install_deps installs python3-distributed", CANNOT_DO) from None
    dask.config.set({"distributed.scheduler.allowed-failures": DEATHS, "logging.distributed": "critical",
                     "distributed.comm.timeouts.connect": "10s"})
    cloudpickle.register_pickle_by_value(sys.modules[__name__])  # workers need Dask and the program, not this package
    with contextlib.ExitStack() as stack:
        try:
            where = options.scheduler or stack.enter_context(distributed.LocalCluster(
                n_workers=options.workers, threads_per_worker=1, processes=True, host="127.0.0.1",
                dashboard_address="127.0.0.1:0", silence_logs=logging.CRITICAL))
            client = stack.enter_context(distributed.Client(where, set_as_default=False))
        except (OSError, ValueError) as error:
            raise Failure(f"no Dask scheduler answers at {options.scheduler or 'this machine'}: {error}",
                          CANNOT_DO) from None
        yield client


def say(options, done, parts, receipt, models):
    if options.json:
        print(json.dumps({"event": "part", **receipt}), flush=True)
    elif sys.stderr.isatty():
        end = "\n" if done == parts else ""
        print(f"\r{done} of {parts} parts, {models} models ", end=end, file=sys.stderr, flush=True)


def collect(options, client, program, words, parts):
    """Waits for all receipts; the first refusal ends it."""
    from distributed import as_completed
    from distributed.scheduler import KilledWorker
    futures = [client.submit(build_part, program, words, f"{part}/{parts}", pure=False) for part in range(parts)]
    models = 0
    try:
        for done, future in enumerate(as_completed(futures, loop=client.loop), 1):
            receipt = future.result()
            if "failure" in receipt:
                code = receipt["code"] if receipt["code"] > 0 else CANNOT_DO
                raise Failure(receipt["failure"].removeprefix("voxid: "), code)
            models += receipt["models"]
            say(options, done, parts, receipt, models)
    except KilledWorker:
        raise Failure(f"{DEATHS} workers died at the same models; what is finished waits for --resume",
                      CANNOT_DO) from None
    finally:
        client.cancel(futures)


def run(program, arguments):
    options = options_of(arguments)
    if not os.path.isdir(options.models):
        raise Failure(f"{options.models}: No such file or directory", CANNOT_DO)
    words = words_of(options)
    with locked_parts(options.out, options.resume), client_of(options) as client:
        collect(options, client, program, words, tasks_for(options.models))
    sys.stdout.flush()
    more = ["--json"] if options.json else []
    os.execv(program, [program, "build", *words, "--resume", *more])
