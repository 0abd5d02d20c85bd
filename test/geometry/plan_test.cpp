// SPDX-License-Identifier: BSD-3-Clause
#include "plan.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace voxid {
namespace {

std::vector<Point2> hullOf(std::vector<Point2> points) {
  std::sort(points.begin(), points.end(), [](Point2 a, Point2 b) { return a.x != b.x ? a.x < b.x : a.y < b.y; });
  std::vector<Point2> hull(2 * points.size() + 1);
  hull.resize(convexHull({points.data(), points.size()}, hull.data()));
  return hull;
}

std::vector<int> flat(const std::vector<Point2>& points) {
  std::vector<int> numbers;
  for (const Point2& p : points) numbers.insert(numbers.end(), {p.x, p.y});
  return numbers;
}

TEST(ConvexHull, IsCounterClockwiseAndLeavesOutInnerAndStraightPoints) {
  EXPECT_EQ(flat(hullOf({{0, 0}, {4, 0}, {4, 4}, {0, 4}, {2, 2}, {2, 0}, {4, 2}, {0, 0}})),
            (std::vector<int>{0, 0, 4, 0, 4, 4, 0, 4}));
}

TEST(ConvexHull, OfFewPointsIsThosePoints) {
  EXPECT_TRUE(hullOf({}).empty());
  EXPECT_EQ(hullOf({{3, 4}}).size(), 1u);
  EXPECT_EQ(hullOf({{3, 4}, {3, 4}, {3, 4}}).size(), 1u);
  EXPECT_EQ(hullOf({{0, 0}, {1, 1}, {2, 2}, {3, 3}}).size(), 2u);
}

TEST(Rays, FollowThePinhole) {
  Rays rays;
  rays.fill(Camera::fromPixels(500, 250, 10, 20), 40, 40);
  const PointUm p = rays.point(35, 10, 2000000);
  EXPECT_NEAR(p.x, 100000, 3);  // 25 px / 500 at 2 m
  EXPECT_NEAR(p.y, -80000, 3);  // -10 px / 250
  EXPECT_EQ(p.z, 2000000);
}

TEST(Plan, MeasuresHeightAboveThePlane) {
  Plan plan;
  plan.set({Eigen::Vector3d(0, -0.6, -0.8), 0.5});
  EXPECT_NEAR(plan.heightUm({0, 300000, 400000}), 0, 2);
  EXPECT_NEAR(plan.heightUm({0, 240000, 320000}), 100000, 2);
  const Eigen::Vector3d lifted = plan.lift(0.1, 0.2, 0.05);
  const PointUm back{static_cast<std::int32_t>(lifted.x() * 1e6), static_cast<std::int32_t>(lifted.y() * 1e6),
                     static_cast<std::int32_t>(lifted.z() * 1e6)};
  EXPECT_NEAR(plan.project(back).x, 100000, 3);
  EXPECT_NEAR(plan.project(back).y, 200000, 3);
  EXPECT_NEAR(plan.heightUm(back), 50000, 3);
}

}  // namespace
}  // namespace voxid
