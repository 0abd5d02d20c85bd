// SPDX-License-Identifier: BSD-3-Clause
// What the fast path over hulls leaves out must not matter.
#include "outermost.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace voxid {
namespace {

using Points = std::vector<Point2>;

std::vector<std::pair<int, int>> hullOf(Points points) {
  std::sort(points.begin(), points.end(), [](Point2 a, Point2 b) { return a.x != b.x ? a.x < b.x : a.y < b.y; });
  Points hull(2 * points.size() + 1);
  hull.resize(convexHull({points.data(), points.size()}, hull.data()));
  std::vector<std::pair<int, int>> corners;
  for (const Point2& p : hull) corners.emplace_back(p.x, p.y);
  return corners;
}

Points outermostOf(const Points& points) {
  std::vector<std::int32_t> x, y;
  for (const Point2& p : points) {
    x.push_back(p.x);
    y.push_back(p.y);
  }
  Outermost outermost;
  const Span<const Point2> kept = outermost.of(x.data(), y.data(), points.size());
  return {kept.begin(), kept.end()};
}

/// Points evenly spread over a rectangle that is turned by the unit vector (c, s), or over the ellipse in it.
Points spread(int length_um, int width_um, double c, double s, bool ellipse) {
  std::mt19937 random(7);
  Points points;
  while (points.size() < 5000) {
    const double a = random() / 4294967296.0 * 2 - 1, b = random() / 4294967296.0 * 2 - 1;
    if (ellipse && a * a + b * b > 1) continue;
    const double x = a * length_um / 2, y = b * width_um / 2;
    points.push_back({static_cast<int>(c * x - s * y) + 300000, static_cast<int>(s * x + c * y) - 200000});
  }
  return points;
}

TEST(Outermost, KeepsEveryCornerOfTheHullAndLittleElse) {
  for (const bool ellipse : {false, true}) {
    const Points points = spread(300000, 100000, 0.8, 0.6, ellipse);
    const Points kept = outermostOf(points);
    EXPECT_EQ(hullOf(kept), hullOf(points));
    EXPECT_LT(kept.size(), points.size() / 4);
  }
  const Points large = spread(90000000, 70000000, 0.6, 0.8, true);  // where floats round by some micrometres
  EXPECT_EQ(hullOf(outermostOf(large)), hullOf(large));
}

TEST(Outermost, OfFewPointsOrALineIsAllThatMatters) {
  for (const Points& points : {Points{{5, 6}}, Points{{5, 6}, {5, 6}}, Points{{0, 0}, {7, 7}, {3, 3}},
                               Points{{0, 0}, {900000, 300000}, {300000, 100000}}}) {
    EXPECT_EQ(hullOf(outermostOf(points)), hullOf(points));
  }
  EXPECT_TRUE(outermostOf({}).empty());
}

}  // namespace
}  // namespace voxid
