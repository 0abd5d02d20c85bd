// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/geometry/longest_extent.h"

#include <gtest/gtest.h>

#include <cmath>

#include "rendered.h"

namespace voxid {
namespace {

constexpr int kWidth = 640, kHeight = 480;

/// A plate that faces the camera at 1,000 mm, as wide and high in pixels, about the middle.
struct Plate {
  explicit Plate(int width_px, int height_px)
      : image{kWidth, kHeight, std::vector<std::uint16_t>(kWidth * kHeight), test::View().camera()} {
    for (int v = (kHeight - height_px) / 2; v < (kHeight + height_px) / 2; ++v)
      for (int u = (kWidth - width_px) / 2; u < (kWidth + width_px) / 2; ++u) set(u, v, 1000);
  }
  void set(int u, int v, std::uint16_t depth_mm) {
    image.at(u, v) = depth_mm;
    pixels.push_back(static_cast<std::uint32_t>(v * kWidth + u));
  }
  float longest_mm() const { return LongestExtent().of_mm(image.view(), {pixels.data(), pixels.size()}); }

  test::Image image;
  std::vector<std::uint32_t> pixels;
};

TEST(LongestExtent, IsTheDiagonalOfAPlate) {
  // f = 525 px, so 1 px is 1.9 mm. 0.3 % of a plate at each of two corners: up to 8 % of the diagonal.
  const double diagonal_mm = std::hypot(200.0, 120.0);
  EXPECT_GT(Plate(105, 63).longest_mm(), 0.92 * diagonal_mm);
  EXPECT_LT(Plate(105, 63).longest_mm(), diagonal_mm);
  EXPECT_NEAR(Plate(210, 10).longest_mm(), 400, 0.03 * 400);
}

TEST(LongestExtent, AFewStrayPixelsAreNoLength) {
  Plate plate(105, 63);
  const float alone_mm = plate.longest_mm();
  for (int i = 0; i < 3; ++i) plate.set(i, 0, 1000);  // 600 mm away
  EXPECT_NEAR(plate.longest_mm(), alone_mm, 3);
}

TEST(LongestExtent, NothingIsNoLonger) {
  Plate plate(0, 0);
  EXPECT_EQ(plate.longest_mm(), 0);
  plate.set(5, 5, 0);
  EXPECT_EQ(plate.longest_mm(), 0);
  plate.set(6, 6, 800);
  EXPECT_EQ(plate.longest_mm(), 0) << "one point";
}

}  // namespace
}  // namespace voxid
