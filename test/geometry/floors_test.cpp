// SPDX-License-Identifier: BSD-3-Clause
// Floors that lie too low to be told from the table, and table that is no floor.
#include <gtest/gtest.h>

#include <vector>

#include "geometry/rendered.h"
#include "voxid/geometry/segmenter.h"

namespace voxid {
namespace {

using test::Box;
using test::View;

constexpr double kX = 0.05, kY = 0.7, kSide_m = 0.2, kWall_m = 0.016, kHeight_m = 0.03;

std::vector<Box> frame(double bottom_m = 0) {
  constexpr double half = kSide_m / 2;
  return {{kX, kY + half, kSide_m + kWall_m, kWall_m, bottom_m + kHeight_m, 0, bottom_m},
          {kX - half, kY, kWall_m, kSide_m, bottom_m + kHeight_m, 0, bottom_m},
          {kX + half, kY, kWall_m, kSide_m, bottom_m + kHeight_m, 0, bottom_m},
          {kX, kY - half, kSide_m + kWall_m, kWall_m, bottom_m + kHeight_m, 0, bottom_m}};
}

/// Whether an object holds the pixel in the middle of the frame.
bool isFloor(std::vector<Box> boxes, double floor_m) {
  if (floor_m > 0) boxes.push_back({kX, kY, kSide_m, kSide_m, floor_m});
  const View view;
  const test::Image image = render(view, boxes);
  const Eigen::Vector3d middle = test::inCamera(view, kX, kY, floor_m);
  const auto u = static_cast<std::uint32_t>(319.5 + 525 * middle.x() / middle.z() + 0.5),
             v = static_cast<std::uint32_t>(239.5 + 525 * middle.y() / middle.z() + 0.5);
  Segmenter segmenter;
  for (const Cluster& cluster : segmenter.segment(image.view(), SegmentParams{}).clusters)
    for (const std::uint32_t pixel : cluster.pixels)
      if (pixel == v * 640 + u) return true;
  return false;
}

TEST(Floors, ALowFloorIsOfThePanThatSurroundsIt) {
  EXPECT_TRUE(isFloor(frame(), 0.003));
  EXPECT_TRUE(isFloor(frame(), 0.005));
}

TEST(Floors, TableInARingIsTable) { EXPECT_FALSE(isFloor(frame(), 0)); }

TEST(Floors, WhatIsOpenToOneSideIsTable) {
  for (std::size_t side = 0; side < 4; ++side) {
    std::vector<Box> boxes = frame();
    boxes.erase(boxes.begin() + static_cast<std::ptrdiff_t>(side));
    EXPECT_FALSE(isFloor(boxes, 0.003)) << side;
  }
}

TEST(Floors, WhatIsSeenThroughAHandleIsNoFloor) {
  std::vector<Box> boxes = frame(0.1);  // in the air
  const test::Image with_table = render(View{}, boxes);
  boxes.push_back({kX, kY + 0.14, 0.3, 0.3, 0.003});
  const test::Image with_sheet = render(View{}, boxes);
  Segmenter segmenter;
  const auto pixels = [&](const test::Image& image) {
    return segmenter.segment(image.view(), SegmentParams{}).clusters[0].pixels.size;
  };
  EXPECT_EQ(pixels(with_sheet), pixels(with_table));
}

TEST(Floors, WhatStandsOnAFloorStaysItself) {
  std::vector<Box> boxes = frame();
  boxes.push_back({kX, kY, kSide_m, kSide_m, 0.003});
  boxes.push_back({kX, kY, 0.05, 0.05, 0.06});
  Segmenter segmenter;
  const test::Image image = render(View{}, boxes);
  EXPECT_EQ(segmenter.segment(image.view(), SegmentParams{}).clusters.size, 2u);
}

}  // namespace
}  // namespace voxid
