// SPDX-License-Identifier: BSD-3-Clause
// Which parts become several objects.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "geometry/rendered.h"
#include "voxid/geometry/segmenter.h"

namespace voxid {
namespace {

using test::Box;
using test::render;
using test::View;

/// Heights in millimetres of the objects found, ascending.
std::vector<int> heightsOf(const test::Image& image, const SegmentParams& params = {}) {
  Segmenter segmenter;
  std::vector<int> found_mm;
  for (const Cluster& c : segmenter.segment(image.view(), params).clusters) {
    found_mm.push_back(static_cast<int>(std::lround(static_cast<double>(c.extents_m.z()) * 1e3)));
  }
  std::sort(found_mm.begin(), found_mm.end());
  return found_mm;
}

const std::vector<Box> kTouching{{0, 0.55, 0.16, 0.1, 0.06}, {0, 0.65, 0.16, 0.1, 0.16}};
const std::vector<Box> kStacked{{0, 0.6, 0.3, 0.24, 0.08}, {0, 0.62, 0.1, 0.1, 0.2, 30, 0.08}};

TEST(Split, ALowBoxAtAHighOneIsTwo) {
  const std::vector<int> found_mm = heightsOf(render(View{}, kTouching));
  ASSERT_EQ(found_mm.size(), 2u);
  EXPECT_NEAR(found_mm[0], 60, 8);  // the crease is two pixels wide on either side
  EXPECT_NEAR(found_mm[1], 160, 3);
}

TEST(Split, ABoxOnABoxIsTwo) {
  const std::vector<int> found_mm = heightsOf(render(View{}, kStacked));
  ASSERT_EQ(found_mm.size(), 2u);
  EXPECT_NEAR(found_mm[0], 80, 10);
  EXPECT_NEAR(found_mm[1], 200, 3);
}

TEST(Split, WorksInAQuarterOfThePixels) {
  View quarter;
  quarter.width_px = 320;
  quarter.height_px = 240;
  EXPECT_EQ(heightsOf(render(quarter, kTouching)).size(), 2u);
  EXPECT_EQ(heightsOf(render(quarter, kStacked)).size(), 2u);
}

TEST(Split, WorksInTheWidestImages) {
  View wide;
  wide.width_px = 5120;
  wide.height_px = 2000;
  EXPECT_EQ(heightsOf(render(wide, kTouching)).size(), 2u);
}

TEST(Split, EdgesThatBulgeAreNoCreases) {
  EXPECT_EQ(heightsOf(render(View{}, {{0, 0.65, 0.2, 0.2, 0.15, 40}})).size(), 1u);
}

TEST(Split, AVesselStaysOne) { EXPECT_EQ(heightsOf(render(View{}, {}, {{0, 0.7, 0.06, 0.14}})).size(), 1u); }

TEST(Split, CanBeSwitchedOff) {
  SegmentParams off;
  off.split = false;
  EXPECT_EQ(heightsOf(render(View{}, kTouching), off).size(), 1u);
}

TEST(Split, SmallPiecesGoToTheirNeighbours) {
  SegmentParams large;
  large.split_min_pixels = 20000;
  EXPECT_EQ(heightsOf(render(View{}, kTouching), large).size(), 1u);
}

}  // namespace
}  // namespace voxid
