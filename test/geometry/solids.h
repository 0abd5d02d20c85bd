// SPDX-License-Identifier: BSD-3-Clause
// Meshes by formula, in millimetres or any other unit.
#pragma once

#include <cmath>

#include "voxid/library/mesh.h"

namespace voxid::test {

inline void addBox(Mesh& mesh, const Mesh::Vertex& low, const Mesh::Vertex& high) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (int i = 0; i < 8; ++i)
    mesh.vertices.push_back({i & 1 ? high[0] : low[0], i & 2 ? high[1] : low[1], i & 4 ? high[2] : low[2]});
  constexpr std::uint32_t kFaces[6][4] = {{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                          {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}};
  for (const auto& f : kFaces) {
    mesh.triangles.push_back({first + f[0], first + f[1], first + f[2]});
    mesh.triangles.push_back({first + f[0], first + f[2], first + f[3]});
  }
}

/// A wall of `corners` faces round the y axis, with lids.
inline void addCylinder(Mesh& mesh, float radius, float bottom, float top, int corners = 48) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.push_back({0, bottom, 0});
  mesh.vertices.push_back({0, top, 0});
  for (int i = 0; i < corners; ++i) {
    const float angle = 6.2831853f * static_cast<float>(i) / static_cast<float>(corners);
    for (const float y : {bottom, top})
      mesh.vertices.push_back({radius * std::cos(angle), y, radius * std::sin(angle)});
  }
  for (int i = 0; i < corners; ++i) {
    const std::uint32_t a = first + 2 + 2 * static_cast<std::uint32_t>(i),
                        b = first + 2 + 2 * static_cast<std::uint32_t>((i + 1) % corners);
    mesh.triangles.push_back({a, b, a + 1});
    mesh.triangles.push_back({b, b + 1, a + 1});
    mesh.triangles.push_back({first, a, b});
    mesh.triangles.push_back({first + 1, a + 1, b + 1});
  }
}

/// Three arms of different lengths: no symmetry.
inline Mesh corner() {
  Mesh mesh;
  addBox(mesh, {0, 0, 0}, {100, 20, 20});
  addBox(mesh, {0, 0, 0}, {25, 70, 25});
  addBox(mesh, {0, 0, 0}, {30, 15, 45});
  return mesh;
}

inline Mesh box(float x, float y, float z) {
  Mesh mesh;
  addBox(mesh, {0, 0, 0}, {x, y, z});
  return mesh;
}

inline Mesh cylinder(float radius, float height) {
  Mesh mesh;
  addCylinder(mesh, radius, 0, height);
  return mesh;
}

}  // namespace voxid::test
