# SPDX-License-Identifier: BSD-3-Clause
"""voxid_command.py VOXID SUBCOMMAND [OPTIONS]: the sub-commands of `voxid` that are written in Python."""
import os
import signal
import sys

# As built this is a link into the sources; what is compiled of the package lies beside the link.
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from voxid.failure import BAD_USE, CANNOT_DO, Failure  # noqa: E402


def loaded(command):
    """The function that runs it on (program, arguments)."""
    if command == "acquire":
        from voxid.acquire import command as acquire
        return acquire.run
    if command == "build":
        from voxid import distribute
        return distribute.run
    if command == "library":
        from voxid.acquire import list_library
        return lambda _, arguments: list_library.run(arguments)
    raise Failure(f"{command} is no sub-command that is written in Python", BAD_USE)


def say(sentence):
    print(f"voxid: {' '.join(str(sentence).split())}", file=sys.stderr)


def leave_output():
    """What is still to be written there is given up, or Python tries again as it ends."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def run_whole(run):
    """The exit code, once what was printed has arrived."""
    try:
        code = run(sys.argv[1], sys.argv[3:])
    except SystemExit as ended:  # argparse's --help
        code = ended.code
    try:
        sys.stdout.flush()
    except BrokenPipeError:
        raise
    except OSError as error:
        leave_output()
        raise Failure(f"cannot write to standard output: {error.strerror}") from None
    return code


def main():
    if sys.stdout is None:  # closed by the caller
        sys.stdout = open(os.devnull, "w")
    try:
        run = loaded(sys.argv[2])
        # The caller held interrupts back: modules that are interrupted while they load say something of their own.
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
        return run_whole(run)
    except Failure as failure:
        say(failure.sentence)
        return failure.code
    except BrokenPipeError:  # the reader has had enough
        leave_output()
        return CANNOT_DO
    except KeyboardInterrupt:
        say("interrupted")
        return CANNOT_DO
    except OSError as error:
        say(f"{error.filename or 'cannot read or write'}: {error.strerror or error}")
        leave_output()
        return CANNOT_DO


if __name__ == "__main__":
    sys.exit(main())
