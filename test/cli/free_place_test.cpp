// SPDX-License-Identifier: BSD-3-Clause
#include "free_place.h"

#include <gtest/gtest.h>

namespace voxid::cli {
namespace {

constexpr int kHeight_px = 100;

TEST(FreePlace, IsTheOneWantedIfNothingLiesThere) {
  const cv::Rect wanted(10, 40, 30, 12);
  EXPECT_EQ(freePlace(wanted, {}, kHeight_px), wanted);
  EXPECT_EQ(freePlace(wanted, {{40, 40, 30, 12}, {10, 52, 30, 12}}, kHeight_px), wanted);  // these only touch it
}

TEST(FreePlace, IsTheNearestThatCoversNothing) {
  const cv::Rect wanted(10, 40, 30, 12);
  EXPECT_EQ(freePlace(wanted, {wanted}, kHeight_px), cv::Rect(10, 28, 30, 12));
  EXPECT_EQ(freePlace(wanted, {wanted, {0, 28, 20, 12}}, kHeight_px), cv::Rect(10, 52, 30, 12));
}

TEST(FreePlace, LiesInsideThePicture) {
  const cv::Rect top(10, 3, 30, 12), bottom(10, kHeight_px - 14, 30, 12);
  EXPECT_EQ(freePlace(top, {top}, kHeight_px), cv::Rect(10, 15, 30, 12));
  EXPECT_EQ(freePlace(bottom, {bottom}, kHeight_px), cv::Rect(10, kHeight_px - 26, 30, 12));
}

TEST(FreePlace, IsTheOneWantedInAFullPicture) {
  const cv::Rect wanted(10, 40, 30, 12);
  EXPECT_EQ(freePlace(wanted, {{0, 0, 100, kHeight_px}}, kHeight_px), wanted);
}

}  // namespace
}  // namespace voxid::cli
