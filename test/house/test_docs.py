# SPDX-License-Identifier: BSD-3-Clause
"""The documents point at things that are there."""
import re

import pytest

LINK = re.compile(r"\[[^\]]*\]\(([^)\s]+)\)")
COMMAND = re.compile(r"(?:^|[\s`$(])((?:\./)?(?:scripts|lcm/examples|\.ci)/[\w./-]+)")


def documents(root, tracked):
    return [path for path in tracked if path.suffix == ".md"]


def test_every_relative_link_resolves(root, tracked):
    wrong = []
    for path in documents(root, tracked):
        for target in LINK.findall((root / path).read_text()):
            file, _, _ = target.partition("#")
            if "://" in target or target.startswith("mailto:") or not file:
                continue
            if not ((root / path).parent / file).exists():
                wrong.append(f"{path}: {target}")
    assert wrong == []


def test_every_anchor_resolves(root, tracked):
    wrong = []
    for path in documents(root, tracked):
        for target in LINK.findall((root / path).read_text()):
            file, _, anchor = target.partition("#")
            if "://" in target or not anchor:
                continue
            page = (root / path).parent / file if file else root / path
            headings = re.findall(r"^#+ (.*)$", page.read_text(), re.MULTILINE)
            anchors = {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}
            if anchor not in anchors:
                wrong.append(f"{path}: {target}")
    assert wrong == []


def test_every_command_named_in_a_document_exists(root, tracked):
    wrong = {f"{path}: {command}" for path in documents(root, tracked)
             for command in COMMAND.findall((root / path).read_text())
             if not (root / command.rstrip(".")).exists()}
    assert wrong == set()


def test_subcommands_named_in_the_readme_exist(root):
    main = (root / "src/cli/main.cpp").read_text()
    known = set(re.findall(r'^    {"(\w+)", "', main, re.MULTILINE))
    named = set(re.findall(r"scripts/voxid ([a-z]+)\b", (root / "README.md").read_text()))
    assert named <= known


def test_launch_files_named_in_documents_exist(root, tracked):
    named = {(str(path), name) for path in documents(root, tracked)
             for name in re.findall(r"roslaunch voxid (\S+\.launch)", (root / path).read_text())}
    assert [pair for pair in sorted(named) if not (root / "launch" / pair[1]).exists()] == []


def test_readme_is_short_and_begins_with_a_picture_and_two_commands(root):
    lines = (root / "README.md").read_text().splitlines()
    assert len(lines) <= 150
    first_screen = "\n".join(lines[:40])
    assert re.search(r"!\[[^\]]*\]\(doc/\w+\.(png|jpg)\)", first_screen)
    assert "scripts/demo" in first_screen and "scripts/test" in first_screen


@pytest.mark.parametrize("document",
                         ["HACKING.md", "CONTRIBUTING.md", "CHANGELOG.rst", "LICENSE", "doc/architecture.md"])
def test_documents_are_there(root, document):
    assert len((root / document).read_text()) > 500
