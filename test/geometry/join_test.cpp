// SPDX-License-Identifier: BSD-3-Clause
// Which parts become one object.
#include <gtest/gtest.h>

#include <algorithm>
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

}  // namespace
}  // namespace voxid
