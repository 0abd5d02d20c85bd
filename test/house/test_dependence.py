# SPDX-License-Identifier: BSD-3-Clause
"""The rule of dependence (doc/architecture.md): core knows nobody, geometry knows core, library and capture know
those two, nodelets and cli know all and are known by none. Held for includes and for link lines."""
import re

import pytest

MAY_KNOW = {
    "core": {"core"},
    "geometry": {"core", "geometry"},
    "library": {"core", "geometry", "library"},
    "capture": {"core", "geometry", "capture"},
    "pcl": {"core", "geometry", "pcl"},
}
# What each part may include from outside; the C++ library is free for all.
OUTSIDE = {
    "core": r"$.",  # nothing
    "geometry": r"Eigen/",
    "library": r"Eigen/|assimp/|embree3/|nlohmann/|yaml-cpp/",
    "capture": r"OpenNI\.h|Driver/|openni2/",
    "pcl": r"pcl/|Eigen/",
}
# POSIX and compiler headers that the parts use beside the C++ library.
SYSTEM = r"(sys/|linux/|arpa/)?[a-z0-9_]+\.h"
CPP = r"[a-z_0-9]+"
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]', re.MULTILINE)


def sources(root, part):
    for folder in (root / "include/voxid" / part, root / "src" / part):
        yield from (path for path in sorted(folder.rglob("*")) if path.suffix in {".h", ".hpp", ".cpp"})


def includes(path):
    return INCLUDE.findall(path.read_text())


@pytest.mark.parametrize("part", MAY_KNOW)
def test_a_part_includes_only_the_parts_it_may_know(root, part):
    wrong = [(str(path.relative_to(root)), name) for path in sources(root, part) for _, name in includes(path)
             if name.startswith("voxid/") and name.split("/")[1] not in MAY_KNOW[part]]
    assert wrong == []


@pytest.mark.parametrize("part", MAY_KNOW)
def test_a_part_includes_only_the_libraries_it_may_use(root, part):
    allowed = re.compile(f"(?:{OUTSIDE[part]})|(?:{SYSTEM}$)|(?:{CPP}$)")
    wrong = [(str(path.relative_to(root)), name) for path in sources(root, part) for mark, name in includes(path)
             if mark == "<" and not allowed.match(name)]
    assert wrong == []


def test_core_has_sources(root):
    assert len(list(sources(root, "core"))) > 10  # else the tests above would hold for an empty folder


def without_comments_and_strings(text):
    return re.sub(r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"', "", text, flags=re.DOTALL)


@pytest.mark.parametrize("word", ["throw", "try", "catch", "dynamic_cast", "typeid"])
def test_core_neither_throws_nor_catches(root, word):
    wrong = [str(path.relative_to(root)) for path in sources(root, "core")
             if re.search(rf"\b{word}\b", without_comments_and_strings(path.read_text()))]
    assert wrong == []


@pytest.mark.parametrize("word", [r"\brand\s*\(", r"\bsrand\b", r"random_device", r"mt19937", r"_clock::now",
                                  r"\btime\s*\(", r"\bgetenv\b",
                                  r"std::(cout|cerr)", r"\bf?printf\s*\("])
def test_core_and_geometry_have_no_clock_chance_environment_or_output(root, word):
    wrong = [str(path.relative_to(root)) for part in ("core", "geometry") for path in sources(root, part)
             if re.search(word, without_comments_and_strings(path.read_text()))]
    assert wrong == []


LINKS = re.compile(r"target_link_libraries\s*\(\s*(\w+)\s+([^)]*)\)")
MAY_LINK = {
    "voxid_core": set(),
    "voxid_geometry": {"voxid_core"},
    "voxid_library": {"voxid_core", "voxid_geometry"},
    "voxid_capture": {"voxid_core", "voxid_geometry"},
}
KEYWORDS = {"PUBLIC", "PRIVATE", "INTERFACE"}
OUTSIDE_TARGETS = {
    "voxid_core": r"$.",
    "voxid_geometry": r"Eigen3::Eigen$",
    "voxid_library": r"(embree|nlohmann_json::nlohmann_json|yaml-cpp|Threads::Threads|\$\{CMAKE_DL_LIBS\})$",
    "voxid_capture": r"(PkgConfig::OPENNI2|Threads::Threads|\$\{CMAKE_DL_LIBS\})$",
}


@pytest.mark.parametrize("target", MAY_LINK)
def test_a_target_links_only_what_it_may_know(root, target):
    text = (root / "src" / target.removeprefix("voxid_") / "CMakeLists.txt").read_text()
    linked = {name.replace("voxid::", "voxid_") for found, names in LINKS.findall(text) if found == target
              for name in names.split() if name not in KEYWORDS}
    ours = {name for name in linked if name.startswith("voxid")}
    assert ours <= MAY_LINK[target]
    assert [name for name in linked - ours if not re.match(OUTSIDE_TARGETS[target], name)] == []
