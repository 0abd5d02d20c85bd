// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "voxid/library/mesh.h"

namespace voxid {

/// What a mesh file may cost. Above either, the file is refused.
struct MeshReaderLimits {
  int seconds = 60;                                     ///< for Assimp's process
  std::uint64_t memory_bytes = std::uint64_t{4} << 30;  ///< address space of Assimp's process beyond its start
};

/// Whether a file's name ends like a mesh that readMesh() takes (doc/build.md has the list); upper case counts.
bool isMeshFile(const std::string& name);

/// Reads a mesh of any common format (PLY, OBJ, STL, OFF, glTF, Collada, 3DS, ...) and keeps what can be rendered.
/// PLY is read by voxid itself; everything else, and a PLY with elements that voxid does not know, by Assimp in a
/// process of its own, lib/voxid/voxid_read_mesh: a file that crashes it, hangs it or eats memory costs one refusal.
/// Any thread may call it. CannotDo: no such file, no known format, Assimp refused, crashed or ran out of its limits,
/// or it cannot be started ("cannot start ...", which says nothing of the file). Damaged: a PLY that is cut or refers
/// to vertices that it does not have. NothingFound: no triangle with an area.
Result<Mesh> readMesh(const std::string& path, const MeshReaderLimits& limits = {});

/// readMesh(), whose refusals all begin with the path.
Result<Mesh> readMeshFile(const std::string& path);

/// The two ways apart, without keepRenderable().
Result<Mesh> readPly(const std::string& path);
Result<Mesh> readByAssimp(const std::string& path, const MeshReaderLimits& limits = {});

}  // namespace voxid
