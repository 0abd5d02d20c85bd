// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <fstream>

#include "voxid/library/mesh.h"

namespace voxid::test {

/// Writes the mesh as a text PLY, with the folders that it lies in.
inline void writePly(const Mesh& mesh, const std::filesystem::path& path) {
  std::filesystem::create_directories(path.parent_path());
  std::ofstream file(path);
  file << "ply\nformat ascii 1.0\nelement vertex " << mesh.vertices.size()
       << "\nproperty float x\nproperty float y\nproperty float z\nelement face " << mesh.triangles.size()
       << "\nproperty list uchar int vertex_indices\nend_header\n";
  for (const auto& v : mesh.vertices) file << v[0] << ' ' << v[1] << ' ' << v[2] << '\n';
  for (const auto& t : mesh.triangles) file << "3 " << t[0] << ' ' << t[1] << ' ' << t[2] << '\n';
}

}  // namespace voxid::test
