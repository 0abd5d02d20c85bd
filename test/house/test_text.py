# SPDX-License-Identifier: BSD-3-Clause
"""What every file of the repository keeps to."""
import os
import re

import pytest

CODE = {".h", ".hpp", ".cpp", ".py"}
TEXT = CODE | {".md", ".rst", ".txt", ".yaml", ".yml", ".xml", ".cmake", ".launch", ".test", ".msg", ".lcm", ".cfg",
               ".rviz", ""}
ME = "test/house/test_text.py"


def texts(root, tracked, suffixes=frozenset(TEXT)):
    for path in tracked:
        if path.suffix in suffixes and str(path) != ME:
            try:
                yield path, (root / path).read_text()
            except UnicodeDecodeError:
                continue


@pytest.mark.parametrize("pattern", [r"/(?:work|root)/", r"/hom[e]/(?!\$)\w",
                                     r"https?://(?:[\w.-]*\.)?(?:pypi|pythonhosted|ubuntu\.com|debian\.org/debian\b)",
                                     r"\bartifactory\b"])
def test_no_path_or_host_of_one_machine(root, tracked, pattern):
    wrong = [f"{path}: {found[0]}" for path, text in texts(root, tracked)
             if (found := re.search(rf".*{pattern}.*", text))]
    assert wrong == []


# Spelt with a class so that the pattern does not find itself.
@pytest.mark.parametrize("pattern", [r"\bTOD[O]\b", r"\bFIXM[E]\b", r"\bXX[X]\b", r"\bHAC[K]\b", r"<<<<<<[<]",
                                     r"\bas an A[I]\b", r"\bplaceholde[r]\b"])
def test_nothing_is_left_open(root, tracked, pattern):
    wrong = [f"{path}: {found[0].strip()}" for path, text in texts(root, tracked)
             if (found := re.search(rf".*{pattern}.*", text))]
    assert wrong == []


def test_code_names_its_licence(root, tracked):
    generated_elsewhere = {"cfg"}
    wrong = [str(path) for path, text in texts(root, tracked, frozenset(CODE))
             if path.parts[0] not in generated_elsewhere
             and "SPDX-License-Identifier: BSD-3-Clause" not in "".join(text.splitlines(True)[:2])]
    assert wrong == []


def test_headers_are_guarded_by_pragma_once(root, tracked):
    headers = texts(root, tracked, frozenset({".h", ".hpp"}))
    assert [str(path) for path, text in headers if "#pragma once" not in text] == []


def test_no_file_is_large(root, tracked):
    assert [str(path) for path in tracked if (root / path).stat().st_size > 1_000_000] == []


def test_scripts_are_executable_and_say_how_they_are_called(root, tracked):
    for path in tracked:
        if path.parts[0] != "scripts" or path.suffix or path.name == "env.sh":
            continue
        text = (root / path).read_text()
        assert text.startswith("#!"), path
        assert os.access(root / path, os.X_OK), path
        assert path.name in text, f"{path} does not say how it is called"


def test_python_of_ros_is_the_systems(root, tracked):
    """Another python3 may be first on PATH, and it knows no rospy."""
    scripts = texts(root, tracked, frozenset({".py", ""}))
    assert [str(path) for path, text in scripts if re.match(r"#!.*env python", text)] == []


def test_lines_of_python_and_scripts_fit_a_screen(root, tracked):
    """C++ is laid out by clang-format; nothing lays out these."""
    wrong = [f"{path}:{number}" for path in tracked if is_script(root / path)
             for number, line in enumerate((root / path).read_text().splitlines(), 1) if len(line) > 120]
    assert wrong == []


def is_script(path):
    return path.suffix in {".py", ".pyi", ".sh"} or (path.suffix == "" and path.read_bytes()[:2] == b"#!")
