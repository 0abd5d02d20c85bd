// SPDX-License-Identifier: BSD-3-Clause
#include "thinned_surface.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "geometry/solids.h"
#include "voxid/library/model_surface.h"

namespace voxid {
namespace {

Eigen::Vector3f extentsOf(const ModelSurface& surface) {
  Eigen::Vector3f low(2, 2, 2), high(-2, -2, -2);
  for (const Eigen::Vector3f& p : surface.vertices) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  return high - low;
}

TEST(ThinnedSurface, KeepsWhereItIsAndLosesTriangles) {
  Mesh mesh;
  test::addCylinder(mesh, 40, 0, 120, 480);
  const ModelSurface surface = surfaceOf(mesh), thin = thinned(surface, 24);
  EXPECT_LT(thin.triangles.size(), surface.triangles.size() / 4);
  EXPECT_GT(thin.triangles.size(), 40u);
  EXPECT_LT((extentsOf(thin) - extentsOf(surface)).cwiseAbs().maxCoeff(), 0.5f / 24);
}

TEST(ThinnedSurface, JoinsNothingThatIsFurtherApartThanACell) {
  const ModelSurface box = surfaceOf(test::box(30, 40, 120)), thin = thinned(box, 24);
  EXPECT_EQ(thin.vertices.size(), box.vertices.size());
  EXPECT_EQ(thin.triangles.size(), box.triangles.size());
}

TEST(ThinnedSurface, WhatLiesInOneCellIsGone) {
  const ModelSurface dot{{{0.01f, 0, 0}, {0.011f, 0, 0}, {0.01f, 0.001f, 0}}, {{0, 1, 2}}};
  EXPECT_TRUE(thinned(dot, 24).triangles.empty());
  EXPECT_TRUE(thinned({}, 24).vertices.empty());
}

}  // namespace
}  // namespace voxid
