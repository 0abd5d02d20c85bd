// SPDX-License-Identifier: BSD-3-Clause
// The part of readByAssimp() that runs in a process of its own, voxid_read_mesh.
#pragma once

#include <cstdint>
#include <string>

#include "voxid/library/mesh_reader.h"

namespace voxid {

/// What the process says before the mesh itself follows: vertices, then triangles.
struct MeshPreamble {
  std::uint64_t vertices = 0, triangles = 0;
  char refusal[240] = {};  ///< empty: the mesh follows
};

/// Limits this process, silences it, reads the file by Assimp, writes preamble and mesh into the pipe, and ends.
[[noreturn]] void importInto(int pipe, const std::string& path, const MeshReaderLimits& limits);

}  // namespace voxid
