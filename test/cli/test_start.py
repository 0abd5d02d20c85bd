# SPDX-License-Identifier: BSD-3-Clause
"""The command starts at once: what brings a hundred libraries is loaded by who needs it (src/cli/on_demand.h)."""
import re
import subprocess


def test_neither_pcl_nor_the_codecs_are_loaded_at_the_start(program):
    libraries = subprocess.run(["ldd", program], capture_output=True, text=True, check=True).stdout
    assert "libopencv_core" in libraries
    assert re.findall(r"lib(?:pcl|vtk|gdal|opencv_imgcodecs|voxid_cli)\w*", libraries) == []
