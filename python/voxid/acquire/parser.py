# SPDX-License-Identifier: BSD-3-Clause
"""argparse, with voxid's one sentence and exit code."""
import argparse

from voxid.failure import BAD_USE, Failure


class Parser(argparse.ArgumentParser):
    def __init__(self, **options):
        super().__init__(allow_abbrev=False, **options)

    def error(self, message):
        raise Failure(f"{message}; see {self.prog} --help", BAD_USE)
