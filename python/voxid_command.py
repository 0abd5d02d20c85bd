# SPDX-License-Identifier: BSD-3-Clause
"""voxid_command.py VOXID SUBCOMMAND [OPTIONS]: the sub-commands of `voxid` that are written in Python."""
import os
import sys

from voxid.failure import BAD_USE, CANNOT_DO, Failure


def run(program, command, arguments):
    if command == "acquire":
        from voxid.acquire import command as acquire
        return acquire.run(program, arguments)
    if command == "build":
        from voxid import distribute
        return distribute.run(program, arguments)
    if command == "library":
        from voxid.acquire import list_library
        return list_library.run(arguments)
    raise Failure(f"{command} is no sub-command that is written in Python", BAD_USE)


def say(sentence):
    print(f"voxid: {' '.join(str(sentence).split())}", file=sys.stderr)


def main():
    try:
        code = run(sys.argv[1], sys.argv[2], sys.argv[3:])
        sys.stdout.flush()
        return code
    except Failure as failure:
        say(failure.sentence)
        return failure.code
    except BrokenPipeError:  # the reader has had enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return CANNOT_DO
    except KeyboardInterrupt:
        say("interrupted")
        return CANNOT_DO
    except OSError as error:
        say(f"{error.filename or 'file'}: {error.strerror or error}")
        return CANNOT_DO


if __name__ == "__main__":
    sys.exit(main())
