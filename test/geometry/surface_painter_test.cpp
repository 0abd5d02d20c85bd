// SPDX-License-Identifier: BSD-3-Clause
#include "surface_painter.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>

#include "core/random.h"

namespace voxid {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::Vector3f;

/// What one cell's ray meets first, a triangle after the other; `depth` 0: nothing.
struct Met {
  double depth = 0;
  Vector3d normal{0, 0, 0};
  bool doubtful = false;  ///< within rounding of an edge, or of another triangle
};

Met slowlyMet(const ModelSurface& surface, const Placement& pose, const Vector3f& ray) {
  constexpr double kRounding = 1e-4;
  Met met;
  for (const auto& corners : surface.triangles) {
    Matrix3d points;
    for (int i = 0; i < 3; ++i)
      points.col(i) = pose(surface.vertices[corners[static_cast<std::size_t>(i)]]).cast<double>();
    if (points.row(2).minCoeff() <= 0.05 * static_cast<double>(pose.scale)) continue;
    if (std::abs(points.determinant()) < 1e-9) continue;
    // ray * depth = points * shares, which add up to one.
    const Vector3d shares_per_depth = points.inverse() * ray.cast<double>();
    const double depth = 1 / shares_per_depth.sum(), least = shares_per_depth.minCoeff() * depth;
    if (std::abs(least) < kRounding) met.doubtful = true;
    if (!(depth > 0) || least < 0) continue;
    if (std::abs(depth - met.depth) < kRounding * depth) met.doubtful = true;
    if (met.depth > 0 && depth > met.depth) continue;
    met.depth = depth;
    met.normal = (points.col(1) - points.col(0)).cross(points.col(2) - points.col(0)).normalized();
  }
  return met;
}

float between(test::Random& random, float least, float most) {
  return least + (most - least) * static_cast<float>(random.below(1 << 20)) / (1 << 20);
}

/// Of all sizes, some of them across the grid's border, some too near to be drawn.
ModelSurface randomTriangles(test::Random& random) {
  ModelSurface surface;
  for (std::uint32_t i = 0; i < 60; ++i) {
    const float size = between(random, 0.01f, 0.8f);
    const Vector3f middle(between(random, -0.6f, 0.6f), between(random, -0.6f, 0.6f), between(random, -0.5f, 0.5f));
    for (int corner = 0; corner < 3; ++corner)
      surface.vertices.push_back(
          middle + Vector3f(between(random, -size, size), between(random, -size, size), between(random, -size, size)));
    surface.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return surface;
}

TEST(SurfacePainter, EveryCellHasWhatItsRayMeetsFirst) {
  test::Random random(1);
  SurfacePainter painter;
  int covered = 0, doubtful = 0, all = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const ModelSurface surface = randomTriangles(random);
    PixelGrid grid;
    grid.width = random.between(1, 45), grid.height = random.between(1, 30);
    grid.fx = between(random, 20, 90), grid.fy = between(random, 20, 90);
    grid.cx = between(random, 0, 40), grid.cy = between(random, 0, 30);
    Placement pose;
    pose.scale = 100;
    pose.translation = Vector3f(0, 0, between(random, 50, 200));
    painter.draw(surface, pose, grid);
    for (std::size_t cell = 0; cell < grid.size(); ++cell) {
      const Met met = slowlyMet(surface, pose, grid.ray(cell));
      ++all;
      doubtful += met.doubtful;
      if (met.doubtful) continue;
      ASSERT_EQ(painter.covers(cell), met.depth > 0) << "trial " << trial << " cell " << cell;
      if (!painter.covers(cell)) continue;
      ++covered;
      ASSERT_NEAR(painter.depth()[cell], met.depth, 1e-3 * met.depth);
      ASSERT_GT(std::abs(painter.normalAt(cell, grid).cast<double>().dot(met.normal)), 0.999);
    }
  }
  EXPECT_GT(covered, all / 3);
  EXPECT_LT(doubtful, all / 5);
}

TEST(SurfacePainter, WhatWasDrawnBeforeIsGone) {
  test::Random random(2);
  const ModelSurface surface = randomTriangles(random);
  PixelGrid large, small;
  large.width = large.height = 40, large.fx = large.fy = 60, large.cx = large.cy = 20;
  small = large;
  small.width = 17;
  Placement pose;
  pose.scale = 100;
  pose.translation = Vector3f(0, 0, 150);
  SurfacePainter used, fresh;
  used.draw(surface, pose, large);
  used.draw(surface, pose, small);
  fresh.draw(surface, pose, small);
  EXPECT_EQ(used.depth().size(), small.size());
  EXPECT_EQ(used.depth(), fresh.depth());
}

}  // namespace
}  // namespace voxid
