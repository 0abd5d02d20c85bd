// SPDX-License-Identifier: BSD-3-Clause
#include "../../src/library/deform.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace voxid {
namespace {

Mesh cube() {
  Mesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.vertices.push_back({i & 1 ? 2.0f : -1.0f, i & 2 ? 2.0f : -1.0f, i & 4 ? 2.0f : -1.0f});
  mesh.triangles = {{0, 1, 2}, {5, 6, 7}};
  return mesh;
}

TEST(Deformed, IsStretchedAndTaperedWithinItsBounds) {
  Random random(3);
  double longest = 0, shortest = 1e9;
  for (int draw = 0; draw < 200; ++draw) {
    const Mesh mesh = deformed(cube(), random);
    ASSERT_EQ(mesh.triangles, cube().triangles);
    const MeshBox box = boxOf(mesh);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double extent = (box.high[axis] - box.low[axis]) / 3;
      EXPECT_GE(extent, 1 / 1.5);
      EXPECT_LE(extent, 1.5 * 1.3001);
      longest = std::max(longest, extent);
      shortest = std::min(shortest, extent);
    }
  }
  EXPECT_GT(longest, 1.4);
  EXPECT_LT(shortest, 0.75);
}

TEST(Deformed, FollowsFromTheSeedAndDiffersBetweenDraws) {
  Random one(7), same(7);
  const Mesh first = deformed(cube(), one);
  EXPECT_EQ(first.vertices, deformed(cube(), same).vertices);
  EXPECT_NE(first.vertices, deformed(cube(), one).vertices);
}

TEST(Deformed, FlatThingsStayFlat) {
  Mesh flat = cube();
  for (Mesh::Vertex& v : flat.vertices) v[1] = 0;
  Random random(1);
  for (int draw = 0; draw < 20; ++draw) {
    const MeshBox box = boxOf(deformed(flat, random));
    EXPECT_EQ(box.low[1], box.high[1]);
  }
}

}  // namespace
}  // namespace voxid
