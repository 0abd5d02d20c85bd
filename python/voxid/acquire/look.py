# SPDX-License-Identifier: BSD-3-Clause
"""look.py MESH FOLDER...: what judge.py wants to know of a mesh, as one JSON object. A process of its own, with limits,
for a mesh may crash it; package voxid is in the folders."""
import base64
import json
import sys
import zlib

VIEWS_EVERY = 8
THUMBNAIL_VIEW = 7
NOT_LOADED = 127  # the exit code where voxid's compiled part is not there


def picture(depth_mm):
    """Millimetres as text that judge.depth_of() reads."""
    return {"shape": depth_mm.shape, "deflated": base64.b64encode(zlib.compress(depth_mm.tobytes(), 1)).decode()}


def look(voxid, path):
    mesh = vertices, triangles = voxid.read_mesh(path)
    extents = vertices.max(axis=0).astype(float) - vertices.min(axis=0)
    depth_mm, _ = voxid.render(mesh, THUMBNAIL_VIEW, clean=True)
    return {"triangles": len(triangles), "extents": extents.tolist(), "bins": voxid.describe(mesh).tolist(),
            "views": voxid.numbers(voxid.describe_views(mesh, VIEWS_EVERY)).tolist(), "thumbnail": picture(depth_mm)}


def main():
    sys.path[:1] = sys.argv[2:]
    try:
        import voxid
        print(json.dumps(look(voxid, sys.argv[1])))
    except ImportError as error:
        print(error, file=sys.stderr)
        return NOT_LOADED
    except MemoryError:
        print("more memory is needed to read it than it may have", file=sys.stderr)
        return 1
    except (OSError, ValueError) as error:
        print(error, file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
