// SPDX-License-Identifier: BSD-3-Clause
// The low points that belong to an object, and those that do not.
#include <gtest/gtest.h>

#include "geometry/rendered.h"
#include "voxid/geometry/segmenter.h"

namespace voxid {
namespace {

using test::Image;
using test::render;
using test::View;

/// Pixels of the objects found.
std::size_t pixelsOf(const Image& image, bool rim) {
  SegmentParams params;
  params.rim = rim;
  Segmenter segmenter;
  std::size_t pixels = 0;
  for (const Cluster& cluster : segmenter.segment(image.view(), params).clusters) pixels += cluster.pixels.size;
  return pixels;
}

/// Pixels of `full` that differ from the empty table by more than a millimetre.
std::size_t pixelsAbove(const Image& full, const Image& empty) {
  std::size_t pixels = 0;
  for (std::size_t i = 0; i < full.millimetres.size(); ++i) {
    pixels += full.millimetres[i] + 1 < empty.millimetres[i];
  }
  return pixels;
}

TEST(Rim, IsMostOfWhatIsLowerThanTheThreshold) {
  const Image image = render(View{}, {{0, 0.6, 0.2, 0.12, 0.06}});
  const std::size_t all = pixelsAbove(image, render(View{}, {}));
  const std::size_t without = pixelsOf(image, false), with = pixelsOf(image, true);
  ASSERT_LT(without, all);
  EXPECT_GT(with, without);
  EXPECT_LE(with, all);
  EXPECT_LT(all - with, (all - without) * 8 / 10);
}

TEST(Rim, IsNoMoreThanAFewPixelsWide) {
  // Beside the box lies a sheet of 5 mm, which is too low to be an object and too far away to be rim.
  const Image box = render(View{}, {{0, 0.6, 0.1, 0.1, 0.06}});
  const Image both = render(View{}, {{0, 0.6, 0.1, 0.1, 0.06}, {0.2, 0.6, 0.2, 0.1, 0.005}});
  EXPECT_LT(pixelsOf(both, true), pixelsOf(box, true) + 500);
}

TEST(Rim, PixelsAscendAndAreOfOneObjectOnly) {
  const Image image = render(View{}, {{-0.06, 0.6, 0.1, 0.1, 0.03}, {0.06, 0.6, 0.1, 0.1, 0.06}});
  Segmenter segmenter;
  std::vector<int> taken(image.millimetres.size());
  for (const Cluster& cluster : segmenter.segment(image.view(), SegmentParams{}).clusters) {
    std::uint32_t before = 0;
    for (const std::uint32_t pixel : cluster.pixels) {
      EXPECT_TRUE(pixel > before);
      EXPECT_EQ(taken[pixel]++, 0);
      before = pixel;
    }
  }
}

TEST(Rim, ASlabOfEightMillimetresIsFound) {
  const Image image = render(View{}, {{0, 0.7, 0.1, 0.07, 0.008}});
  EXPECT_GT(pixelsOf(image, true), pixelsAbove(image, render(View{}, {})) * 9 / 10);
}

}  // namespace
}  // namespace voxid
