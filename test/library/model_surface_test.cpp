// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/library/model_surface.h"

#include <gtest/gtest.h>

#include <cmath>

#include "geometry/solids.h"

namespace voxid {
namespace {

KeptSurface read(const std::vector<std::uint8_t>& bytes) { return *KeptSurface::of({bytes.data(), bytes.size()}); }

/// A hilly sheet of side x side vertices.
Mesh sheet(std::uint32_t side) {
  Mesh mesh;
  for (std::uint32_t i = 0; i < side * side; ++i) {
    const auto x = static_cast<float>(i % side), y = static_cast<float>(i / side);
    mesh.vertices.push_back({x, y, 10 * std::sin(x / 20) * std::cos(y / 30)});
  }
  for (std::uint32_t i = 0; i + side < side * side; ++i) {
    if (i % side == side - 1) continue;
    mesh.triangles.push_back({i, i + 1, i + side});
    mesh.triangles.push_back({i + 1, i + side, i + side + 1});
  }
  return mesh;
}

TEST(KeepSurface, IsReadAsItWasToHalfAUnit) {
  Mesh mesh;
  test::addCylinder(mesh, 40, -60, 60);
  const ModelSurface surface = surfaceOf(mesh);
  const auto bytes = surfaceToKeep(mesh);
  const ModelSurface kept = surfaceOf(read(bytes));
  ASSERT_EQ(kept.vertices.size(), surface.vertices.size());
  for (std::size_t i = 0; i < kept.vertices.size(); ++i)
    EXPECT_LE((kept.vertices[i] - surface.vertices[i]).lpNorm<Eigen::Infinity>(), 0.51f / format::kSurfaceUnits);
  EXPECT_EQ(kept.triangles.size(), surface.triangles.size());
  EXPECT_EQ(symmetryOf(read(bytes)).folds, findSymmetry(surface).folds);
}

TEST(KeepSurface, DetailsBelowACellAreJoined) {
  const Mesh fine = sheet(250);
  const ModelSurface kept = surfaceOf(read(surfaceToKeep(fine)));
  EXPECT_LT(kept.vertices.size(), fine.vertices.size());
  const SurfaceSamples before(surfaceOf(fine), 80000);  // some 0.003 of the diagonal apart
  for (const Eigen::Vector3f& vertex : kept.vertices) EXPECT_LT(before.distanceTo(vertex), 1.0f / kKeptCells);
}

TEST(KeepSurface, AsManyVerticesAsItMayHaveAreNotExceeded) {
  Mesh mesh;
  const Mesh one = sheet(280);
  for (int layer = 0; layer < 4; ++layer) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const Mesh::Vertex& v : one.vertices) mesh.vertices.push_back({v[0], v[1], v[2] + 40.0f * layer});
    for (const auto& t : one.triangles) mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
  const auto bytes = surfaceToKeep(mesh);
  EXPECT_LE(read(bytes).header().vertices, format::kMaxSurfaceVertices);
  EXPECT_GT(read(bytes).header().vertices, format::kMaxSurfaceVertices / 8);
}

}  // namespace
}  // namespace voxid
