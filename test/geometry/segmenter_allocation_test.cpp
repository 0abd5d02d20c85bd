// SPDX-License-Identifier: BSD-3-Clause
// After the first frame of a size segmentation takes no memory. This binary counts every allocation.
#include <gtest/gtest.h>

#include <algorithm>

#include "counted_allocations.h"
#include "geometry/rendered.h"
#include "voxid/geometry/segmenter.h"

namespace voxid {
namespace {

TEST(SegmenterAllocation, IsCounted) {
  const int before = allocations;
  std::vector<int>(100).swap(*std::make_unique<std::vector<int>>());
  EXPECT_GT(allocations, before);
}

TEST(SegmenterAllocation, AfterWarmUpThereIsNone) {
  const test::View view;
  const test::Image full = test::render(view, {{-0.2, 0.65, 0.2, 0.12, 0.06, 20}, {0.2, 0.8, 0.1, 0.08, 0.18, -30}});
  test::Image noise = full, dark = full;
  std::fill(dark.millimetres.begin(), dark.millimetres.end(), std::uint16_t{0});
  std::uint32_t state = 1;
  for (std::uint16_t& mm : noise.millimetres) {
    state = state * 1664525 + 1013904223;
    mm = static_cast<std::uint16_t>(mm + (state >> 16) % 60);
  }
  test::View half = view;
  half.width_px = 320;
  half.height_px = 240;
  const test::Image smaller = test::render(half, {{0, 0.7, 0.2, 0.2, 0.1}});
  const std::vector<float> metres = test::metresOf(full);
  const SegmentParams params;
  SegmentParams few;
  few.max_clusters = 1;

  Segmenter segmenter;
  segmenter.segment(dark.view(), params);
  const int before = allocations;
  segmenter.segment(full.view(), params);
  segmenter.segment(noise.view(), params);
  segmenter.segment(full.view(), few);
  segmenter.segment(smaller.view(), params);
  segmenter.segment(test::viewOf(metres, full), params);
  segmenter.segment(DepthView{}, params);
  EXPECT_EQ(allocations - before, 0);
}

}  // namespace
}  // namespace voxid
