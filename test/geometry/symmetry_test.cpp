// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/geometry/symmetry.h"

#include <gtest/gtest.h>

#include "geometry/solids.h"
#include "voxid/library/model_surface.h"

namespace voxid {
namespace {

using Folds = std::array<std::uint8_t, 3>;

Folds foldsOf(const Mesh& mesh) { return findSymmetry(surfaceOf(mesh)).folds; }

TEST(Symmetry, OfSolids) {
  EXPECT_EQ(foldsOf(test::cylinder(40, 100)), (Folds{2, 0, 2}));
  EXPECT_EQ(foldsOf(test::box(30, 60, 100)), (Folds{2, 2, 2}));
  EXPECT_EQ(foldsOf(test::box(30, 30, 100)), (Folds{2, 2, 4}));
  EXPECT_EQ(foldsOf(test::corner()), (Folds{1, 1, 1}));
}

TEST(Symmetry, OfAnEmptySurfaceIsNone) { EXPECT_EQ(findSymmetry(ModelSurface{}).folds, (Folds{1, 1, 1})); }

TEST(Symmetry, TurnsLeaveASquareBarWhereItIs) {
  const ModelSurface surface = surfaceOf(test::box(30, 30, 100));
  const auto turns = turnsOf(findSymmetry(surface));
  EXPECT_TRUE(turns.front().isIdentity());
  EXPECT_GE(turns.size(), 8u);  // four quarter turns, upside down or not; some more than once
  const SurfaceSamples samples(surface, 5000);
  for (const auto& turn : turns) {
    for (const Eigen::Vector3f& corner : surface.vertices) EXPECT_LT(samples.distanceTo(turn * corner), 0.03f);
  }
}

TEST(SurfaceSamples, MeasureDistances) {
  const SurfaceSamples samples(surfaceOf(test::box(100, 1, 1)), 4000);
  EXPECT_EQ(samples.points().size(), 4000u);
  EXPECT_NEAR(samples.distanceTo({0, 0.3f, 0}), 0.3f, 0.01f);
  EXPECT_NEAR(samples.distanceTo({1.5f, 0, 0}), 1.0f, 0.01f);
  EXPECT_EQ(SurfaceSamples(ModelSurface{}, 10).distanceTo({0, 0, 0}), 2);
}

}  // namespace
}  // namespace voxid
