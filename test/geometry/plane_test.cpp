// SPDX-License-Identifier: BSD-3-Clause
#include "plane.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "geometry/rendered.h"

namespace voxid {
namespace {

TEST(InverseDepth, HasTheSameValueForBothUnits) {
  test::Image image{5, 1, {0, 300, 1234, 9999, 10001}, Camera::fromPixels(525, 525, 2, 0)};
  const std::vector<float> metres = test::metresOf(image);
  InverseDepth from_mm, from_m;
  invert(image.view(), 300, 10000, from_mm);
  invert(test::viewOf(metres, image), 300, 10000, from_m);
  EXPECT_EQ(from_mm.values, from_m.values);
  EXPECT_EQ(from_mm.valid, 3u);
  EXPECT_EQ(from_m.valid, 3u);
  EXPECT_EQ(from_mm.values[2], std::lround(256e6 / 1234));
  EXPECT_EQ(from_mm.values[0], 0);
  EXPECT_EQ(from_mm.values[4], 0);
  EXPECT_NEAR(depthUmOf(from_mm.values[2]), 1234000, 4);
}

TEST(MetricPlane, IsTheInversePlaneInSpace) {
  const Camera camera = Camera::fromPixels(500, 500, 320, 240);
  // The plane z = 2 m.
  const MetricPlane wall = metricOf({0, 0, 500.0 * kUnitsPerKm}, camera);
  EXPECT_NEAR(wall.distance_m, 2, 1e-9);
  EXPECT_NEAR((wall.normal - Eigen::Vector3d(0, 0, -1)).norm(), 0, 1e-9);
}

TEST(PlaneFinder, TheRoughCountIsNeverTheSmaller) {
  std::mt19937 random(11);
  const auto below = [&](int bound) { return static_cast<std::int32_t>(random() % static_cast<unsigned>(bound)); };
  for (int round = 0; round < 2000; ++round) {
    const int side_px = round % 2 ? 640 : 8192;
    const InversePlane plane{0.37 * (below(2001) - 1000), 0.73 * (below(2001) - 1000), 300.0 * below(1000)};
    PlaneFinder::Samples samples;
    const int tolerance = below(4000);
    for (int i = 0; i < 100; ++i) {  // at the tolerance's very edge
      const int u = below(side_px), v = below(side_px), edge = i % 2 ? tolerance : -tolerance;
      const double inverse = plane.per_u * u + plane.per_v * v + plane.at_origin + edge;
      if (inverse > 0 && inverse < (1 << 22)) samples.add(u, v, static_cast<std::int32_t>(std::floor(inverse)));
    }
    const Eigen::Vector3d normal(-plane.per_u, -plane.per_v, 1);
    const int exact = PlaneFinder::countInliers(samples, normal, plane.at_origin, tolerance, -1);
    EXPECT_GE(PlaneFinder::mostInliers(samples, plane, tolerance), exact);
    EXPECT_EQ(PlaneFinder::mostInliers(samples, plane, tolerance - 100), 0);
  }
}

TEST(PlaneFinder, FindsTheRenderedTable) {
  const test::View view;
  const test::Image image = test::render(view, {{0, 0.7, 0.2, 0.15, 0.1}, {-0.25, 0.6, 0.1, 0.1, 0.2}});
  InverseDepth inverse;
  invert(image.view(), 300, 2500, inverse);
  InversePlane plane;
  PlaneSums sums;
  ASSERT_TRUE(PlaneFinder().find(inverse, image.camera, SegmentParams{}, Upward{}, plane, sums));
  const MetricPlane metric = metricOf(plane, image.camera);
  EXPECT_NEAR(metric.distance_m, 0.6, 0.0005);
  EXPECT_GT(metric.normal.dot(test::inCamera(view, 0, 0, 1) - test::inCamera(view, 0, 0, 0)),
            std::cos(0.05 * test::kRadian));
}

/// Of the plane that is found where a camera 1.35 m above a floor sees these plates on it; metres.
double distanceOver(const std::vector<test::Box>& plates) {
  test::View room;
  room.camera_height_m = 1.35;
  room.left_m = -3;
  room.right_m = 3;
  room.near_m = 0.2;
  room.far_m = 5;
  const test::Image image = test::render(room, plates);
  InverseDepth inverse;
  invert(image.view(), 300, 4000, inverse);
  InversePlane plane;
  PlaneSums sums;
  if (!PlaneFinder().find(inverse, image.camera, SegmentParams{}, Upward{}, plane, sums)) return 0;
  return metricOf(plane, image.camera).distance_m;
}

TEST(PlaneFinder, PrefersATableToTheFloorBelowIt) {
  EXPECT_NEAR(distanceOver({{0, 0.8, 0.6, 0.5, 0.75}}), 0.6, 0.005);
  EXPECT_NEAR(distanceOver({{0, 1.2, 0.9, 0.7, 0.35}}), 1.0, 0.005);  // a low one
}

TEST(PlaneFinder, PrefersTheTableToABenchBeforeIt) {
  EXPECT_NEAR(distanceOver({{0, 0.8, 2.4, 0.9, 0.35}, {0, 0.8, 0.6, 0.5, 0.75}}), 0.6, 0.005);
}

TEST(PlaneFinder, TakesALowStepAndASmallPlateForNoTable) {
  EXPECT_NEAR(distanceOver({{0, 1.2, 0.9, 0.7, 0.25}}), 1.35, 0.005);
  EXPECT_NEAR(distanceOver({{0, 0.8, 0.25, 0.2, 0.75}}), 1.35, 0.005);
}

}  // namespace
}  // namespace voxid
