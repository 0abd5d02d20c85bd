// SPDX-License-Identifier: BSD-3-Clause
// Which parts become one object.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "geometry/rendered.h"
#include "voxid/geometry/segmenter.h"

namespace voxid {
namespace {

using test::render;
using test::View;

std::vector<float> lengths(const test::Image& image) {
  Segmenter segmenter;
  std::vector<float> found;
  for (const Cluster& c : segmenter.segment(image.view(), SegmentParams{}).clusters) found.push_back(c.extents_m.x());
  std::sort(found.begin(), found.end());
  return found;
}

TEST(Join, ABoxThatANearerOneCutsInTwoStaysOne) {
  const auto found = lengths(render(View{}, {{0, 0.9, 0.4, 0.08, 0.12}, {0, 0.55, 0.06, 0.06, 0.3}}));
  ASSERT_EQ(found.size(), 2u);
  EXPECT_NEAR(found[1], 0.4f, 0.008f);
}

TEST(Join, TwoBoxesOfOtherHeightsBehindANearerOneStayTwo) {
  const auto found = lengths(
      render(View{}, {{-0.12, 0.9, 0.16, 0.08, 0.12}, {0.12, 0.9, 0.16, 0.08, 0.14}, {0, 0.55, 0.06, 0.06, 0.3}}));
  EXPECT_EQ(found.size(), 3u);
}

TEST(Join, TwoBoxesOneFartherThanTheOtherBehindANearerOneStayTwo) {
  const auto found = lengths(
      render(View{}, {{-0.12, 0.9, 0.16, 0.08, 0.12}, {0.12, 1.0, 0.16, 0.08, 0.12}, {0, 0.55, 0.06, 0.06, 0.3}}));
  EXPECT_EQ(found.size(), 3u);
}

TEST(Join, WhatIsHiddenOverALongWayStaysTwo) {
  EXPECT_EQ(lengths(render(View{}, {{0, 0.9, 0.7, 0.08, 0.12}, {0, 0.55, 0.2, 0.06, 0.36}})).size(), 3u);
}

TEST(Join, TwoBoxesWithTableBetweenThemStayTwo) {
  EXPECT_EQ(lengths(render(View{}, {{-0.12, 0.8, 0.16, 0.08, 0.12}, {0.12, 0.8, 0.16, 0.08, 0.12}})).size(), 2u);
}

TEST(Join, WallsOfAVesselAreOne) {
  const auto found = lengths(render(View{}, {}, {{0, 0.7, 0.06, 0.14}}));
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found[0], 0.12f, 0.008f);
}

TEST(Join, WallsOfWhatIsWiderThanAnyVesselStayTwo) {
  EXPECT_EQ(lengths(render(View{}, {}, {{0, 0.78, 0.22, 0.3}})).size(), 2u);
}

TEST(Join, ABoxBehindABoxOfItsHeightStaysItself) {
  EXPECT_EQ(lengths(render(View{}, {{0, 0.6, 0.15, 0.04, 0.12}, {0, 0.72, 0.15, 0.04, 0.12}})).size(), 2u);
}

/// A tray of 24 by 18 cm with a floor of 12 mm and walls of 4 cm.
std::vector<test::Box> tray() {
  constexpr double x = 0, y = 0.7, length = 0.24, width = 0.18, wall = 0.012, height = 0.04;
  return {{x, y, length, width, 0.012},
          {x, y - width / 2, length + wall, wall, height},
          {x, y + width / 2, length + wall, wall, height},
          {x - length / 2, y, wall, width, height},
          {x + length / 2, y, wall, width, height}};
}

std::vector<test::Box> trayWith(const test::Box& thing) {
  std::vector<test::Box> boxes = tray();
  boxes.push_back(thing);
  return boxes;
}

TEST(Join, WallAndFloorOfAVesselAreOne) {
  const auto found = lengths(render(View{}, tray()));
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found[0], 0.252f, 0.01f);
}

TEST(Join, WhatStandsInAVesselStaysItself) {
  for (const double height : {0.032, 0.12}) {  // below the rim and above
    const auto found = lengths(render(View{}, trayWith({0, 0.71, 0.09, 0.06, height})));
    ASSERT_EQ(found.size(), 2u) << height;
    EXPECT_LT(found[0], 0.13f) << "a border cell more to either side";
  }
}

/// Above the table.
/// Of a point above the table.
double heightOf(const View& view, const Eigen::Vector3d& in_camera) {
  return view.camera_height_m - in_camera.y() * std::cos(view.pitch_deg * test::kRadian) -
         in_camera.z() * std::sin(view.pitch_deg * test::kRadian);
}

/// Draws a hollow ball into an image, open above `top`; the table hides what lies below it.
void addBall(const View& view, const Eigen::Vector3d& centre, double radius, test::Image& image, double top = 1) {
  const Eigen::Vector3d in_camera = test::inCamera(view, centre.x(), centre.y(), centre.z());
  for (int v = 0; v < image.height_px; ++v) {
    for (int u = 0; u < image.width_px; ++u) {
      const Eigen::Vector3d ray((u - 319.5) / 525, (v - 239.5) / 525, 1);
      const double along = ray.dot(in_camera) / ray.squaredNorm();
      const double root = radius * radius - (in_camera - along * ray).squaredNorm();
      if (root < 0) continue;
      const double half = std::sqrt(root / ray.squaredNorm());
      const bool is_outside = heightOf(view, (along - half) * ray) <= top;
      if (!is_outside && heightOf(view, (along + half) * ray) > top) continue;
      std::uint16_t& depth_mm = image.at(u, v);
      const auto ball_mm = static_cast<std::uint16_t>(std::lround(1000 * (is_outside ? along - half : along + half)));
      if (depth_mm == 0 || ball_mm < depth_mm) depth_mm = ball_mm;
    }
  }
}

TEST(Join, WhatBulgesInAVesselStaysItself) {
  const View from_above{0.7, 60};
  constexpr double y = 0.42, side = 0.17, wall = 0.012, height = 0.065;
  const std::vector<test::Box> frame{{0, y - side / 2, side + wall, wall, height},
                                     {0, y + side / 2, side + wall, wall, height},
                                     {-side / 2, y, wall, side, height},
                                     {side / 2, y, wall, side, height}};
  std::vector<test::Box> filled = frame;
  filled.push_back({0, y, side, side, 0.035});
  EXPECT_EQ(lengths(render(from_above, filled)).size(), 1u);
  test::Image image = render(from_above, frame);
  addBall(from_above, {0, y, -0.09}, 0.13, image);
  EXPECT_EQ(lengths(image).size(), 2u) << "as high in its middle";
}

TEST(Join, WhatIsSeenThroughTheMouthOfAJarIsTheJar) {
  for (const View& view : {View{0.6, 40}, View{0.8, 40}, View{0.6, 60}, View{0.8, 60}}) {
    for (const double top : {0.12, 0.13, 0.14}) {
      test::Image image = render(view, {});
      addBall(view, {0, 0.55, 0.08}, 0.08, image, top);
      const auto found = lengths(image);
      ASSERT_EQ(found.size(), 1u) << view.pitch_deg << " " << view.camera_height_m << " " << top;
      EXPECT_NEAR(found[0], 0.16f, 0.02f);
    }
  }
}

/// A ball on a larger one, whose centre lies so far to the side of its axis, and farther away.
std::size_t snowmen(double aside_m, double away_m) {
  const View view;
  test::Image image = render(view, {});
  addBall(view, {0.1, 0.7, 0.05}, 0.05, image);
  addBall(view, {0.1 + aside_m, 0.7 + away_m, 0.13}, 0.035, image);
  return lengths(image).size();
}

TEST(Join, WhatWasTurnedOnOneAxisIsOne) { EXPECT_EQ(snowmen(0, 0), 1u); }

TEST(Join, WhatWasPutBesideTheAxisStaysItself) {
  EXPECT_EQ(snowmen(-0.015, 0), 2u);
  EXPECT_EQ(snowmen(0.015, 0), 2u);
  EXPECT_EQ(snowmen(0, -0.015), 2u);
}

TEST(Join, BoxesOnOneAxisAreNotTurned) {
  for (const double turn_deg : {0.0, 20.0, 45.0}) {
    const auto found =
        lengths(render(View{}, {{0, 0.7, 0.16, 0.16, 0.08, turn_deg}, {0, 0.7, 0.08, 0.08, 0.16, turn_deg}}));
    EXPECT_EQ(found.size(), 2u) << turn_deg;
  }
}

TEST(Join, ALowBoxOnAHighOneOrBeforeItStaysItself) {
  for (const double height : {0.094, 0.1})
    EXPECT_EQ(lengths(render(View{}, {{0, 0.7, 0.25, 0.2, 0.08}, {0, 0.7, 0.12, 0.1, height}})).size(), 2u) << height;
  EXPECT_EQ(lengths(render(View{}, {{0, 0.75, 0.25, 0.1, 0.12}, {0, 0.67, 0.12, 0.06, 0.04}})).size(), 2u);
}

}  // namespace
}  // namespace voxid
