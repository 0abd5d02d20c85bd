// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/library/model_surface.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "../geometry/thinned_surface.h"
#include "voxid/library/renderer.h"

namespace voxid {
namespace {

std::int16_t inUnits(float share) {
  return static_cast<std::int16_t>(std::clamp<long>(std::lround(share * format::kSurfaceUnits), -32767, 32767));
}

std::vector<std::uint8_t> bytesOf(const ModelSurface& surface, const Symmetry& symmetry) {
  format::Surface header{};
  header.vertices = static_cast<std::uint32_t>(surface.vertices.size());
  header.triangles = static_cast<std::uint32_t>(surface.triangles.size());
  std::copy(symmetry.folds.begin(), symmetry.folds.end(), header.folds);
  std::vector<std::uint8_t> bytes(sizeof header + 6 * (surface.vertices.size() + surface.triangles.size()));
  std::uint8_t* to = bytes.data();
  const auto put = [&to](const auto& value) {
    std::memcpy(to, &value, sizeof value);
    to += sizeof value;
  };
  put(header);
  for (const Eigen::Vector3f& v : surface.vertices) {
    for (int axis = 0; axis < 3; ++axis) put(inUnits(v[axis]));
  }
  for (const auto& triangle : surface.triangles) {
    for (const std::uint32_t vertex : triangle) put(static_cast<std::uint16_t>(vertex));
  }
  return bytes;
}

ModelSurface smallEnough(const ModelSurface& surface) {
  ModelSurface small = thinned(surface, kKeptCells);
  for (int cells = kKeptCells / 2; small.vertices.size() > format::kMaxSurfaceVertices; cells /= 2)
    small = thinned(surface, cells);
  return small;
}

}  // namespace

ModelSurface surfaceOf(const Mesh& mesh) {
  const Placement unit = unitPlacement(mesh);
  ModelSurface surface;
  surface.vertices.reserve(mesh.vertices.size());
  for (const Mesh::Vertex& v : mesh.vertices) surface.vertices.push_back(unit(Eigen::Vector3f(v[0], v[1], v[2])));
  surface.triangles = mesh.triangles;
  return surface;
}

std::vector<std::uint8_t> surfaceToKeep(const Mesh& mesh) {
  const ModelSurface surface = smallEnough(surfaceOf(mesh));
  return bytesOf(surface, findSymmetry(surface));
}

ModelSurface surfaceOf(const KeptSurface& kept) {
  ModelSurface surface;
  surface.vertices.reserve(kept.header().vertices);
  for (std::uint32_t i = 0; i < kept.header().vertices; ++i) {
    const auto v = kept.vertex(i);
    surface.vertices.push_back(Eigen::Vector3f(v[0], v[1], v[2]) / format::kSurfaceUnits);
  }
  surface.triangles.reserve(kept.header().triangles);
  for (std::uint32_t i = 0; i < kept.header().triangles; ++i) {
    const auto t = kept.triangle(i);
    surface.triangles.push_back({t[0], t[1], t[2]});
  }
  return surface;
}

Symmetry symmetryOf(const KeptSurface& kept) {
  Symmetry symmetry;
  std::copy(std::begin(kept.header().folds), std::end(kept.header().folds), symmetry.folds.begin());
  return symmetry;
}

}  // namespace voxid
