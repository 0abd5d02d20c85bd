# SPDX-License-Identifier: BSD-3-Clause
"""build_part.py FOLDER...: voxid.build() with the arguments on standard input, a JSON object; prints a receipt. A
process of its own, for a build forks and Dask's workers have threads; package voxid is in the folders."""
import json
import signal
import sys


def receipt(arguments):
    """Of what was done, or why it could not be: one sentence and the exit code."""
    import voxid
    from voxid.failure import BAD_USE, CANNOT_DO, DAMAGED
    try:
        report = voxid.build(**arguments, jobs=1)
    except ImportError as error:  # first, for DamagedError cannot be named then
        return {"failure": str(error), "code": CANNOT_DO}
    except voxid.DamagedError as error:
        return {"failure": str(error), "code": DAMAGED}
    except OSError as error:
        return {"failure": str(error), "code": CANNOT_DO}
    except ValueError as error:
        return {"failure": str(error), "code": BAD_USE}
    skipped = [{"model": model, "reason": reason} for model, reason in report.skipped]
    return {"models": report.models, "views": report.views, "skipped": skipped}


if __name__ == "__main__":
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # its worker's to answer
    sys.path[:1] = sys.argv[1:]
    print(json.dumps(receipt(json.load(sys.stdin))))
