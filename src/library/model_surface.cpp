// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/library/model_surface.h"

#include "voxid/library/renderer.h"

namespace voxid {

ModelSurface surfaceOf(const Mesh& mesh) {
  const Placement unit = unitPlacement(mesh);
  ModelSurface surface;
  surface.vertices.reserve(mesh.vertices.size());
  for (const Mesh::Vertex& v : mesh.vertices) surface.vertices.push_back(unit(Eigen::Vector3f(v[0], v[1], v[2])));
  surface.triangles = mesh.triangles;
  return surface;
}

}  // namespace voxid
