# SPDX-License-Identifier: BSD-3-Clause
"""voxid in Python: describe(), Index, render(), build() and more (compiled, numpy in and out), and voxid.acquire and
voxid.distribute, which are written on them. __init__.pyi is the manual."""
import pkgutil

# ROS generates a package of the same name (voxid.msg); whichever comes first on the path finds the other's parts.
__path__ = pkgutil.extend_path(__path__, __name__)
__all__ = ["BuildReport", "DamagedError", "Index", "build", "describe", "describe_views", "merge", "numbers",
           "read_mesh", "render"]


def __getattr__(name):
    """What is compiled is loaded when it is first asked for: most commands do without."""
    if name not in __all__:
        raise AttributeError(f"module 'voxid' has no attribute '{name}'")
    try:
        from voxid import _native
    except ImportError as error:
        raise ImportError(f"voxid's compiled part cannot be loaded ({error}); build with pybind11-dev installed, "
                          "and take the folder python of the build or share/voxid/python of the installation") from None
    return getattr(_native, name)
