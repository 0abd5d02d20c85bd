# SPDX-License-Identifier: BSD-3-Clause
"""How the command ends when it cannot do what was asked (doc/cli.md, exit codes)."""

CANNOT_DO, BAD_USE, NOTHING_FOUND, DAMAGED = 1, 2, 3, 4


class Failure(Exception):
    """One sentence (what, where, found, expected, remedy) and the exit code."""

    def __init__(self, sentence, code=CANNOT_DO):
        super().__init__(sentence)
        self.sentence, self.code = " ".join(str(sentence).split()), code
