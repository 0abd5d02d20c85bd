# SPDX-License-Identifier: BSD-3-Clause
"""What is written in two places says the same in both."""
import pathlib
import re
import struct
import subprocess
import xml.etree.ElementTree as xml
import zipfile

import yaml


def test_generated_files_follow_from_params_yaml(root):
    check = subprocess.run([root / "scripts/generate_params", "--check"], capture_output=True, text=True)
    assert check.returncode == 0, check.stderr


def test_launch_files_and_nodelets_start_from_the_same_defaults(root):
    groups = yaml.safe_load((root / "cfg/params.yaml").read_text())
    at_start = groups["segmentation"]["at_start"] | groups["classification"]["at_start"]
    for name in ("voxid.launch", "replay.launch"):
        arguments = {arg.get("name"): arg.get("default")
                     for arg in xml.parse(root / "launch" / name).getroot().iter("arg")
                     if arg.get("default") is not None}
        shared = set(arguments) & set(at_start)
        assert shared == {"index", "categories", "size", "confirmed_sizes", "target_frame", "up_frame", "align",
                          "models", "debug"}
        assert {key: arguments[key] for key in shared} == {
            key: str(at_start[key]["default"]).lower() for key in shared}


def test_switches_of_launch_files_are_true_or_false_however_they_are_written(root):
    """roslaunch itself makes a number of 1, which a nodelet does not take for true."""
    launch = xml.parse(root / "launch/voxid.launch").getroot()
    switches = {arg.get("name") for arg in launch.iter("arg") if arg.get("default") in ("true", "false")}
    wrong = [param.get("name") for param in launch.iter("param") if param.get("type") != "bool"
             and param.get("value")[len("$(arg "):-1] in switches]
    assert switches and wrong == []


def version_of_cmake(root):
    return re.search(r"project\(voxid VERSION ([\d.]+)", (root / "CMakeLists.txt").read_text())[1]


def test_version_numbers_agree(root):
    package = xml.parse(root / "package.xml").getroot().findtext("version")
    changelog = re.search(r"^(\d+\.\d+\.\d+) \(", (root / "CHANGELOG.rst").read_text(), re.MULTILINE)[1]
    assert version_of_cmake(root) == package == changelog


def as_table(pairs):
    return {name: int(number) for name, number in pairs}


def constants_of_lcm(root, struct):
    body = re.search(rf"^struct {struct} {{(.*?)^}}", (root / "lcm/voxid.lcm").read_text(), re.MULTILINE | re.DOTALL)[1]
    return as_table(re.findall(r"(\w+)=(\d+)", re.search(r"const int8_t ([^;]*);", body)[1]))


def constants_of_ros(root, message):
    return as_table(re.findall(r"^uint8 (\w+)=(\d+)", (root / f"msg/{message}.msg").read_text(), re.MULTILINE))


def statuses(root):
    scene = (root / "include/voxid/geometry/scene.h").read_text()
    body = re.search(r"enum class SceneStatus[^{]*{(.*?)};", scene, re.DOTALL)[1]
    header = as_table((re.sub(r"(?<!^)([A-Z])", r"_\1", name).upper(), number)
                      for name, number in re.findall(r"(\w+) = (\d+)", body))
    return header, constants_of_ros(root, "Objects"), constants_of_lcm(root, "object_list_t")


def test_statuses_agree_in_header_ros_and_lcm(root):
    header, ros, lcm = statuses(root)
    assert len(header) == 7
    assert header == ros == lcm


def test_states_of_a_models_pose_agree_in_ros_and_lcm(root):
    assert len(constants_of_ros(root, "ModelPose")) == 6
    assert constants_of_ros(root, "ModelPose") == constants_of_lcm(root, "model_pose_t")


def test_drop_reasons_are_those_that_the_messages_document(root):
    scene = (root / "include/voxid/geometry/scene.h").read_text()
    reasons = re.findall(r"\w+", re.search(r"enum class DropReason[^{]*{(.*?)};", scene)[1])
    named = [re.sub(r"(?<!^)([A-Z])", r" \1", reason).lower() for reason in reasons if reason != "kCount"]
    for message in ("Segments", "Objects"):
        documented = re.search(r"^uint32\[\] dropped.*by cause: (.*)$", (root / f"msg/{message}.msg").read_text(),
                               re.MULTILINE)[1]
        assert documented.replace("the ", "").split(", ") == named


def test_every_message_is_built(root):
    built = re.search(r"add_message_files\(FILES([^)]*)\)", (root / "cmake/ros.cmake").read_text())[1].split()
    assert sorted(built) == sorted(path.name for path in (root / "msg").glob("*.msg"))


def test_every_plugin_class_has_a_library_and_a_sentence(root):
    plugins = xml.parse(root / "nodelets/nodelet_plugins.xml").getroot()
    classes = list(plugins.iter("class"))
    assert len(classes) >= 5
    for plugin in classes:
        assert plugin.get("name").startswith("voxid/")
        assert plugin.findtext("description").strip().endswith(".")


def test_every_subcommand_is_documented(root):
    main = (root / "src/cli/main.cpp").read_text()
    names = re.findall(r'^    {"(\w+)", "', main, re.MULTILINE)
    text = (root / "doc/cli.md").read_text()
    assert len(names) >= 9
    assert [name for name in names if not re.search(rf"voxid {name}\b", text)] == []


def test_packages_of_the_manifest_that_cmake_finds_are_depended_on(root):
    components = re.search(r"set\(VOXID_CATKIN_COMPONENTS([^)]*)\)", (root / "cmake/ros.cmake").read_text())[1].split()
    declared = {element.text for element in xml.parse(root / "package.xml").getroot().iter("depend")}
    assert set(components) <= declared


def test_demo_table_names_each_model_once(root):
    table = yaml.safe_load((root / "cfg/demo_names.yaml").read_text())
    names = [name for group in table["categories"].values() for name in group] + table["skipped"]
    assert len(names) == len(set(names))
    assert all(re.fullmatch(r"[a-z]+(_[a-z]+)*", category) for category in table["categories"])
    assert len(table["held_out"]) >= 10


def test_demo_table_covers_the_catalogues(root):
    table = yaml.safe_load((root / "cfg/demo_names.yaml").read_text())
    listed = {name for group in table["categories"].values() for name in group} | set(table["skipped"])
    found = set()
    for path in pathlib.Path("/usr/share/sweethome3d/furniture").glob("*.sh3f"):
        text = zipfile.ZipFile(path).read("PluginFurnitureCatalog.properties").decode("latin-1")
        found |= {name.strip().replace("\\u20ac", "€") for name in re.findall(r"^name#\d+=(.*)$", text, re.MULTILINE)}
    assert found == listed


def sections_of(index):
    data = index.read_bytes()
    count = struct.unpack_from("<I", data, 24)[0]
    return {data[64 + 32 * i:68 + 32 * i].decode() for i in range(count)}


def test_the_page_of_the_index_names_the_descriptors_revisions(root):
    core = root / "include/voxid/core"
    headers = (core / "descriptor.h").read_text() + (core / "depth_descriptor.h").read_text()
    revisions = re.findall(r"k(?:Depth)?DescriptorRevision = (\d+);", headers)
    page = (root / "doc/index_format.md").read_text()
    assert list(re.search(r"`paper`: (\d+), `default`: (\d+); raised", page).groups()) == revisions


def test_the_fuzzer_starts_from_every_section_of_an_index(root):
    headings = re.findall(r"^## (.*)$", (root / "doc/index_format.md").read_text(), re.MULTILINE)
    documented = {tag for heading in headings for tag in re.findall(r"\b[A-Z]{3}[A-Z4]\b", heading)}
    seeds = [sections_of(seed) for seed in (root / "test/data/fuzz").glob("*.vxi")]
    assert len(documented) == 20
    assert set.union(*seeds) == documented
