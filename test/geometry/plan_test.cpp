// SPDX-License-Identifier: BSD-3-Clause
#include "plan.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "above_table.h"

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

TEST(PlanRays, PlacesAsThePlanDoes) {
  const Camera camera = Camera::fromPixels(500, 490, 40, 30);
  Rays rays;
  rays.fill(camera, 80, 60);
  Plan plan;
  plan.set({Eigen::Vector3d(0, -0.6, -0.8), 0.5});
  PlanRays plan_rays;
  plan_rays.fill(rays, plan);
  const std::vector<std::int32_t> inverse(80, static_cast<std::int32_t>(kUnitsTimesUm / 700000));
  for (const int v : {0, 17, 59}) {
    PlacedPoints placed;
    placed.clear(64);
    plan_rays.place(inverse.data() + 16, 16, v, 60, placed);
    plan_rays.place(inverse.data() + 76, 76, v, 4, placed);  // goes on behind them
    ASSERT_EQ(placed.count, 64u);
    std::vector<std::int32_t> heights_um(64);
    plan_rays.heights(inverse.data() + 16, 16, v, 64, heights_um.data());
    EXPECT_EQ(heights_um, placed.height_um);
    for (int i = 0; i < 64; ++i) {
      const auto at = static_cast<std::size_t>(i);
      const PointUm p = rays.point(16 + i, v, depthUmOf(inverse[0]));
      EXPECT_NEAR(placed.x_um[at], plan.project(p).x, 4);
      EXPECT_NEAR(placed.y_um[at], plan.project(p).y, 4);
      EXPECT_NEAR(placed.height_um[at], plan.heightUm(p), 4);
    }
  }
}

/// Heights from `distance_m` over pixels with the inverse depths of a table at 250,000 units.
std::vector<int> statesOf(const std::vector<std::int32_t>& values, double distance_m) {
  PlaneSums table;
  table.columns.assign(values.size(), 200000);
  table.rows.assign(1, 50000);
  AboveTable above;
  above.set(table, distance_m, 10, 300, 2);
  std::vector<std::uint8_t> states(values.size());
  above.mark(values.data(), 0, static_cast<int>(values.size()), DepthStep(15), states.data());
  for (std::size_t u = 0; u < values.size(); ++u) {
    EXPECT_EQ(states[u] > 0, above.contains(values[u], static_cast<int>(u), 0)) << u;
  }
  return {states.begin(), states.end()};
}

TEST(AboveTable, ComparesHeights) {
  // A height of 10 mm at 500 mm is 1 / 0.98 of the table's inverse depth, 300 mm is 1 / 0.4.
  EXPECT_EQ(statesOf({0, 250000, 255000, 255200, 624000, 626000, 240000}, 0.5),
            (std::vector<int>{0, 0, 0, 1, 1, 0, 0}));
  EXPECT_EQ(statesOf({0, 250000, 260000, 5000000}, 0.2), (std::vector<int>{0, 0, 0, 1}));
}

TEST(AboveTable, LinksNeighboursAtOneDepthAcrossBlocks) {
  std::vector<std::int32_t> values(70, 300000);  // 853 mm; 15 mm nearer is 305,400
  values[40] = 310000;
  std::vector<int> expected(70, 2);
  expected[0] = expected[40] = expected[41] = 1;
  EXPECT_EQ(statesOf(values, 0.5), expected);
}

}  // namespace
}  // namespace voxid
