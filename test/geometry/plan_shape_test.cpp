// SPDX-License-Identifier: BSD-3-Clause
#include "plan_shape.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace voxid {
namespace {

constexpr double kHeight_m = 0.6;
const Eigen::Vector2d kCentre_mm(300, 650);

PlacedPoints placed() {
  PlacedPoints points;
  points.reserve(10000);
  points.clear(10000);
  return points;
}

void add(double x_mm, double y_mm, PlacedPoints& points) {
  points.x_um[points.count] = static_cast<std::int32_t>(std::lround(1000 * x_mm));
  points.y_um[points.count] = static_cast<std::int32_t>(std::lround(1000 * y_mm));
  points.height_um[points.count++] = 0;
}

/// The wall of an upright cylinder as the camera sees it, `wide_rad` to either side, or as one sees it from inside.
PlacedPoints wall(double radius_mm, double wide_rad, double noise_mm, double from_inside = 1) {
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0, noise_mm);
  const double towards_rad = std::atan2(-kCentre_mm.y(), -kCentre_mm.x()) + (from_inside < 0 ? 3.14159265 : 0);
  PlacedPoints points = placed();
  for (int i = 0; i < 2000; ++i) {
    const double angle_rad = towards_rad + wide_rad * (2 * (i % 200) / 199.0 - 1), radius = radius_mm + noise(random);
    add(kCentre_mm.x() + radius * std::cos(angle_rad), kCentre_mm.y() + radius * std::sin(angle_rad), points);
  }
  return points;
}

void expectCylinder(const std::optional<Circle>& circle) {
  ASSERT_TRUE(circle);
  EXPECT_LT((circle->centre - kCentre_mm).norm(), 1);
  EXPECT_NEAR(circle->radius, 40, 1);
  EXPECT_NEAR(circle->distance, std::hypot(kCentre_mm.norm(), 600), 1);
}

TEST(Arcs, OfAnUprightCylinderAreItsFrontOutsideAndItsBackInside) {
  PlacedPoints outside = wall(40, 1.4, 0.2), inside = wall(40, 1.4, 0.2, -1);
  const Arcs of_outside = arcsOf(kHeight_m, outside), of_inside = arcsOf(kHeight_m, inside);
  expectCylinder(of_outside.front);
  EXPECT_FALSE(of_outside.back);
  expectCylinder(of_inside.back);
  EXPECT_FALSE(of_inside.front);
}

TEST(Arcs, DoNotMindAHandle) {
  PlacedPoints points = wall(40, 1.4, 0.2);
  const Eigen::Vector2d away = kCentre_mm.normalized(), right(away.y(), -away.x());
  for (int i = 0; i < 40; ++i) {
    const Eigen::Vector2d p = kCentre_mm + right * (40 + i / 4.0);
    for (int k = 0; k < 5; ++k) add(p.x(), p.y(), points);
  }
  const Arcs arcs = arcsOf(kHeight_m, points);
  ASSERT_TRUE(arcs.front);
  EXPECT_LT((arcs.front->centre - kCentre_mm).norm(), 2);
}

bool hasArc(PlacedPoints points) {
  const Arcs arcs = arcsOf(kHeight_m, points);
  return arcs.front || arcs.back;
}

TEST(Arcs, AreNotShortAndNotLarge) {
  EXPECT_FALSE(hasArc(wall(40, 0.4, 0.2)));
  EXPECT_FALSE(hasArc(wall(260, 1.4, 0.2)));
}

TEST(Arcs, AreNoFaceAndNoCornerOfABox) {
  const Eigen::Vector2d away = kCentre_mm.normalized(), right(away.y(), -away.x());
  for (const double turn_rad : {0.0, 0.3, 0.785}) {
    PlacedPoints points = placed();
    for (int i = 0; i <= 400; ++i) {
      const double s = i / 400.0 * 160 - 80;  // along the two faces that are seen
      const Eigen::Vector2d side = s < 0 ? Eigen::Vector2d(s, 0) : Eigen::Vector2d(0, s);
      const double c = std::cos(turn_rad), n = std::sin(turn_rad);
      const Eigen::Vector2d p =
          kCentre_mm + right * (c * side.x() + n * side.y()) + away * (c * side.y() - n * side.x());
      for (int k = 0; k < 5; ++k) add(p.x(), p.y(), points);
    }
    EXPECT_FALSE(hasArc(points)) << turn_rad;
  }
}

TEST(Arcs, OfNothingAreNone) {
  PlacedPoints none = placed();
  EXPECT_FALSE(hasArc(none));
  PlacedPoints one = placed();
  for (int i = 0; i < 100; ++i) add(300, 650, one);
  EXPECT_FALSE(hasArc(one));
}

TEST(AreCoaxial, AllowsMoreAlongTheViewThanAcrossAndMoreFartherAway) {
  const auto at = [](double x_mm, double y_mm, double distance_mm) { return Circle{{x_mm, y_mm}, 30, distance_mm}; };
  EXPECT_TRUE(areCoaxial(at(0, 800, 1000), at(2, 800, 1000)));
  EXPECT_FALSE(areCoaxial(at(0, 800, 1000), at(3, 800, 1000)));
  EXPECT_TRUE(areCoaxial(at(0, 800, 1000), at(0, 806, 1000)));
  EXPECT_FALSE(areCoaxial(at(0, 800, 1000), at(0, 808, 1000)));
  EXPECT_TRUE(areCoaxial(at(0, 1200, 1500), at(3, 1200, 1500)));
}

}  // namespace
}  // namespace voxid
