// SPDX-License-Identifier: BSD-3-Clause
#include "mesh_file.h"

namespace voxid::cli {

Result<Mesh> readMeshFile(const std::string& path) {
  Result<Mesh> mesh = readMesh(path);
  const bool named = mesh.status.sentence.compare(0, path.size(), path) == 0;
  if (!mesh.ok() && !named) mesh.status.sentence = path + ": " + mesh.status.sentence;
  return mesh;
}

}  // namespace voxid::cli
