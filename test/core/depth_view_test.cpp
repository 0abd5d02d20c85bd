// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/core/depth_view.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

namespace voxid {
namespace {

constexpr std::int32_t kLeast = std::numeric_limits<std::int32_t>::min();
constexpr std::int32_t kMost = std::numeric_limits<std::int32_t>::max();

TEST(Camera, KeepsPixelsIn65536ths) {
  const Camera camera = Camera::fromPixels(525, 525.5, 319.5, -0.25);
  EXPECT_TRUE(camera.valid());
  EXPECT_EQ(camera.fx_q16, 525 * 65536);
  EXPECT_EQ(camera.fy_q16, 525 * 65536 + 32768);
  EXPECT_EQ(camera.cx_q16, 319 * 65536 + 32768);
  EXPECT_EQ(camera.cy_q16, -16384);
}

TEST(Camera, RefusesWhatIsNoCamera) {
  const double nan = std::nan(""), infinity = std::numeric_limits<double>::infinity();
  for (const double f : {0.0, -525.0, 32767.0, 1e300, 1e-9, nan, infinity}) {
    EXPECT_FALSE(Camera::fromPixels(f, 525, 320, 240).valid()) << f;
    EXPECT_FALSE(Camera::fromPixels(525, f, 320, 240).valid()) << f;
  }
  for (const double c : {-32768.0, 32767.0, 1e300, nan, infinity, -infinity}) {
    EXPECT_FALSE(Camera::fromPixels(525, 525, c, 240).valid()) << c;
    EXPECT_FALSE(Camera::fromPixels(525, 525, 320, c).valid()) << c;
  }
  EXPECT_FALSE(Camera{}.valid());
}

TEST(BackProject, FollowsThePinhole) {
  const Camera camera = Camera::fromPixels(500, 250, 320, 240);
  const PointUm p = backProject(camera, 420, 190, 1000000);
  EXPECT_EQ(p.x, 200000);
  EXPECT_EQ(p.y, -200000);
  EXPECT_EQ(p.z, 1000000);
}

TEST(BackProject, RoundsToNearestAndAlikeOnBothSides) {
  const Camera camera = Camera::fromPixels(2, 3, 10, 10);
  EXPECT_EQ(backProject(camera, 11, 11, 5).x, 3);  // 2.5, half away from zero
  EXPECT_EQ(backProject(camera, 9, 11, 5).x, -3);  // -2.5
  EXPECT_EQ(backProject(camera, 11, 11, 4).y, 1);  // 1.33
  EXPECT_EQ(backProject(camera, 11, 11, 5).y, 2);  // 1.67
  EXPECT_EQ(backProject(camera, 11, 9, 5).y, -2);  // -1.67
}

TEST(BackProject, SaturatesAtTheLimits) {
  const Camera camera{1, 1, kLeast, kMost};
  const PointUm far = backProject(camera, 32767, -32767, kMost);
  EXPECT_EQ(far.x, kMost);
  EXPECT_EQ(far.y, kLeast);
  const PointUm behind = backProject(camera, kMost, kLeast, kLeast);
  EXPECT_EQ(behind.x, kLeast);
  EXPECT_EQ(behind.y, kMost);
}

TEST(DepthView, MillimetresBecomeMicrometresAlsoInUnalignedRows) {
  std::vector<unsigned char> bytes(3 + 2 * 7);
  const auto put = [&](std::size_t at, std::uint16_t mm) { std::memcpy(bytes.data() + at, &mm, sizeof mm); };
  put(3, 0), put(5, 1), put(7, 525), put(10, 65535), put(12, 2), put(14, 3);
  const DepthView depth{bytes.data() + 3, 3, 2, 7, DepthUnit::MillimetreU16, {}};
  EXPECT_EQ(depth.depthUm(0, 0), 0);
  EXPECT_EQ(depth.depthUm(1, 0), 1000);
  EXPECT_EQ(depth.depthUm(2, 0), 525000);
  EXPECT_EQ(depth.depthUm(0, 1), 65535000);
  EXPECT_EQ(depth.depthUm(2, 1), 3000);
}

std::int32_t depthOf(float metres) {
  return DepthView{&metres, 1, 1, sizeof metres, DepthUnit::MetreF32, {}}.depthUm(0, 0);
}

TEST(DepthView, MetresAreRoundedToMicrometres) {
  EXPECT_EQ(depthOf(1.0f), 1000000);
  EXPECT_EQ(depthOf(0.0000004f), 0);
  EXPECT_EQ(depthOf(0.0000006f), 1);
  for (const int mm : {1, 299, 525, 1234, 9999}) {
    EXPECT_EQ(depthOf(static_cast<float>(mm) / 1000), mm * 1000) << "a float of a millimetre depth must give the same";
  }
}

TEST(DepthView, WhatIsNoDepthIsZero) {
  const float infinity = std::numeric_limits<float>::infinity();
  for (const float metres : {0.0f, -0.0f, -1.0f, std::nanf(""), infinity, -infinity, 65.54f, 1e30f}) {
    EXPECT_EQ(depthOf(metres), 0) << metres;
  }
  EXPECT_GT(depthOf(65.5f), 0);
}

TEST(DepthView, Empty) {
  const std::uint16_t pixel = 1;
  EXPECT_TRUE(DepthView{}.empty());
  EXPECT_TRUE((DepthView{&pixel, 0, 1, 2, DepthUnit::MillimetreU16, {}}.empty()));
  EXPECT_TRUE((DepthView{&pixel, 1, -1, 2, DepthUnit::MillimetreU16, {}}.empty()));
  EXPECT_FALSE((DepthView{&pixel, 1, 1, 2, DepthUnit::MillimetreU16, {}}.empty()));
}

}  // namespace
}  // namespace voxid
