// SPDX-License-Identifier: BSD-3-Clause
// Any bytes as a PLY: refused with a reason, or a mesh whose triangles have their corners. (Other formats are read by
// Assimp in a process of its own.)
#include <cmath>

#include "memory_file.h"
#include "voxid/library/mesh_reader.h"

namespace {

using namespace voxid;

void expectWhole(const Mesh& mesh) {
  for (const Mesh::Triangle& triangle : mesh.triangles) {
    for (const std::uint32_t corner : triangle) {
      if (corner >= mesh.vertices.size()) std::abort();
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const fuzz::MemoryFile file(data, size);
  Result<Mesh> mesh = readPly(file.path());
  if (mesh.ok() == !mesh.status.sentence.empty()) std::abort();
  if (!mesh.ok()) return 0;
  expectWhole(mesh.value);
  if (!keepRenderable(mesh.value).ok()) return 0;
  expectWhole(mesh.value);
  if (mesh.value.triangles.empty() || !std::isfinite(boxOf(mesh.value).diagonal())) std::abort();
  return 0;
}
