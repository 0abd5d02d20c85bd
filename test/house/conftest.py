# SPDX-License-Identifier: BSD-3-Clause
import pathlib
import subprocess

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]


@pytest.fixture(scope="session")
def root():
    return ROOT


@pytest.fixture(scope="session")
def tracked():
    """Paths of the files that belong to the repository, relative to its root; those not yet committed too."""
    listed = subprocess.run(["git", "ls-files", "--cached", "--others", "--exclude-standard"], cwd=ROOT, text=True,
                            capture_output=True)
    if listed.returncode != 0:
        pytest.skip("not a git checkout: the files of the repository are not known")
    return [path for path in map(pathlib.Path, listed.stdout.splitlines()) if (ROOT / path).is_file()]
