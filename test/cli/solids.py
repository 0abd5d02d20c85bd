# SPDX-License-Identifier: BSD-3-Clause
"""Small closed meshes: (vertices, triangles) as lists."""
import math


def box(x, y, z):
    corners = [(x * (i & 1), y * (i >> 1 & 1), z * (i >> 2 & 1)) for i in range(8)]
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    return corners, [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]


def turned(profile, sides=32):
    """Turns a profile of (radius, y) about the y axis."""
    vertices = [(r * math.cos(2 * math.pi * s / sides), y, r * math.sin(2 * math.pi * s / sides))
                for r, y in profile for s in range(sides)]
    triangles = []
    for ring in range(len(profile) - 1):
        for s in range(sides):
            a, b = ring * sides + s, ring * sides + (s + 1) % sides
            triangles += [(a, b, b + sides), (a, b + sides, a + sides)]
    return vertices, triangles


def ball(rings=16):
    return turned([(0.5 * math.sin(math.pi * i / rings), -0.5 * math.cos(math.pi * i / rings))
                   for i in range(rings + 1)])


def write_ply(path, mesh):
    vertices, triangles = mesh
    path.parent.mkdir(parents=True, exist_ok=True)
    lines = ["ply", "format ascii 1.0", f"element vertex {len(vertices)}", *(f"property float {c}" for c in "xyz"),
             f"element face {len(triangles)}", "property list uchar int vertex_indices", "end_header"]
    lines += [" ".join(f"{c:.6f}" for c in v) for v in vertices]
    lines += [f"3 {a} {b} {c}" for a, b, c in triangles]
    path.write_text("\n".join(lines) + "\n")
