// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/core/depth_descriptor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <functional>
#include <numeric>
#include <vector>

#include "voxid/core/crc32c.h"

namespace voxid {
namespace {

constexpr int kWidth = 640, kHeight = 480;

/// A depth image by a formula: depth in millimetres of pixel (u, v), 0 for none.
class Image {
 public:
  explicit Image(const std::function<int(int, int)>& depth_mm, int scale = 1) : pixels_mm_(kWidth * kHeight) {
    for (int v = 0; v < kHeight; ++v) {
      for (int u = 0; u < kWidth; ++u) set(u, v, depth_mm(u, v) * scale);
    }
  }
  DepthView view() const {
    DepthView view;
    view.data = pixels_mm_.data();
    view.width_px = kWidth;
    view.height_px = kHeight;
    view.row_bytes = 2 * kWidth;
    view.camera = Camera::fromPixels(525, 525, 319.5, 239.5);
    return view;
  }
  Span<const std::uint32_t> object() const { return {object_.data(), object_.size()}; }

 private:
  void set(int u, int v, int depth_mm) {
    const int number = v * kWidth + u;
    pixels_mm_[static_cast<std::size_t>(number)] = static_cast<std::uint16_t>(depth_mm);
    if (depth_mm != 0) object_.push_back(static_cast<std::uint32_t>(number));
  }
  std::vector<std::uint16_t> pixels_mm_;
  std::vector<std::uint32_t> object_;
};

bool inDisc(int u, int v, int radius_px) {
  return (u - 320) * (u - 320) + (v - 240) * (v - 240) < radius_px * radius_px;
}

/// Height of a half ball above its rim, mm; 1 pixel is about 1.5 mm at 800 mm.
int dome(int u, int v) {
  const double x = 1.5 * (u - 320), y = 1.5 * (v - 240), square = 90.0 * 90 - x * x - y * y;
  return square > 0 ? static_cast<int>(std::lround(std::sqrt(square))) : 0;
}
int plate(int u, int v) { return inDisc(u, v, 50) ? 800 : 0; }
int ball(int u, int v) { return inDisc(u, v, 55) ? 800 - dome(u, v) : 0; }
int bowl(int u, int v) { return inDisc(u, v, 55) ? 800 + dome(u, v) : 0; }
/// Two plates side by side at different depths, nothing between them.
int steps(int u, int v) {
  return std::abs(v - 240) > 40 || std::abs(u - 320) < 12 || std::abs(u - 320) > 60 ? 0 : u < 320 ? 760 : 840;
}

DepthBins binsOf(const Image& image, std::uint32_t pairs = 4000) {
  DepthDescriber describer({pairs, 1});
  DepthBins bins;
  EXPECT_EQ(describer.describe(image.view(), image.object(), bins), DescribeStatus::Ok);
  return bins;
}

const SubHistogram& histogram(const std::string& name) {
  for (const SubHistogram& h : kDepthHistograms) {
    if (name == h.name) return h;
  }
  ADD_FAILURE() << "no histogram " << name;
  return kDepthHistograms[0];
}

/// Share of a sub-histogram in bins first to last.
double shareOf(const DepthBins& bins, const std::string& name, int first, int last) {
  double share = 0;
  for (int i = first; i <= last; ++i) {
    const double root = bins[histogram(name).first_bin + static_cast<std::size_t>(i)] / 255.0;
    share += root * root;
  }
  return share;
}

TEST(DepthDescriptor, SubHistogramsFollowOneAnother) {
  int next = 0;
  for (const SubHistogram& h : kDepthHistograms) {
    EXPECT_EQ(h.first_bin, next) << h.name;
    next += h.bins;
  }
  EXPECT_EQ(next, kDepthHistogramBins);
}

TEST(DepthDescriptor, SharesOfEachSubHistogramAddUpToOne) {
  for (const auto& shape : {plate, ball, bowl, steps}) {
    const DepthBins bins = binsOf(Image(shape));
    for (const SubHistogram& h : kDepthHistograms) EXPECT_NEAR(shareOf(bins, h.name, 0, h.bins - 1), 1, 0.06) << h.name;
  }
}

TEST(DepthDescriptor, APlateFacesTheCameraAndLinesLieOnIt) {
  const DepthBins bins = binsOf(Image(plate));
  EXPECT_GT(shareOf(bins, "normal's slope", 31, 31), 0.98);
  EXPECT_GT(shareOf(bins, "normals' angle x distance", 0, 7), 0.98);
  EXPECT_GT(shareOf(bins, "line kind x distance", 0, 31), 0.98);
}

TEST(DepthDescriptor, LinesOfABallLieBehindItsSurfaceThoseOfABowlInFront) {
  const DepthBins of_ball = binsOf(Image(ball)), of_bowl = binsOf(Image(bowl));
  EXPECT_GT(shareOf(of_ball, "line kind x distance", 64, 95), 0.3);
  EXPECT_LT(shareOf(of_ball, "line kind x distance", 32, 63), 0.01);
  EXPECT_GT(shareOf(of_bowl, "line kind x distance", 32, 63), 0.3);
  EXPECT_LT(shareOf(of_bowl, "line kind x distance", 64, 95), 0.01);
}

TEST(DepthDescriptor, TheBallIsConvexTheBowlConcave) {
  EXPECT_LT(shareOf(binsOf(Image(ball)), "convexity x normals' angle x distance", 64, 127), 0.1);
  EXPECT_GT(shareOf(binsOf(Image(bowl)), "convexity x normals' angle x distance", 64, 127), 0.9);
}

TEST(DepthDescriptor, LinesAcrossAGapPassOutside) {
  const DepthBins bins = binsOf(Image(steps));
  double outside = 0;  // joint bins whose third digit, base four, is not zero
  for (int joint = 0; joint < 64; ++joint) {
    if (joint % 4 != 0) outside += shareOf(bins, "line parts x distance", 4 * joint, 4 * joint + 3);
  }
  EXPECT_NEAR(outside, 0.5, 0.05);
}

TEST(DepthDescriptor, TwiceAsLargeAndTwiceAsFarIsTheSame) { EXPECT_EQ(binsOf(Image(ball)), binsOf(Image(ball, 2))); }

TEST(DepthDescriptor, TurnedAboutTheViewingAxisIsNearlyTheSame) {
  const auto turned = [](int u, int v) { return steps(320 + (v - 240), 240 + (u - 320)); };
  const DepthBins straight = binsOf(Image(steps), 20000), quarter = binsOf(Image(turned), 20000);
  double cosine = 0, own = 0;
  for (int i = 0; i < kDepthBins; ++i)
    cosine += straight[static_cast<std::size_t>(i)] * quarter[static_cast<std::size_t>(i)];
  for (const std::uint8_t bin : straight) own += bin * bin;
  EXPECT_GT(cosine / own, 0.99);
}

// The bytes themselves, so that another machine or compiler that counts otherwise is found. Raise
// kDepthDescriptorRevision with these.
TEST(DepthDescriptor, GoldenBytes) {
  const auto sumOf = [](int (*shape)(int, int)) {
    const DepthBins bins = binsOf(Image(shape));
    return crc32c(bins.data(), bins.size());
  };
  EXPECT_EQ(kDepthDescriptorRevision, 2u);
  EXPECT_EQ(sumOf(plate), 2509640712u);
  EXPECT_EQ(sumOf(ball), 1362077255u);
  EXPECT_EQ(sumOf(bowl), 3542290228u);
  EXPECT_EQ(sumOf(steps), 141135467u);
}

TEST(DepthDescriptor, WhatHasNoExtentIsSaid) {
  DepthDescriber describer({100, 1});
  DepthBins bins;
  const Image image(ball);
  EXPECT_EQ(describer.describe(image.view(), {}, bins), DescribeStatus::Empty);
  EXPECT_EQ(describer.describe(DepthView{}, image.object(), bins), DescribeStatus::Empty);
  const std::vector<std::uint32_t> outside{0xffffffff, 640 * 480, 0};
  EXPECT_EQ(describer.describe(image.view(), {outside.data(), outside.size()}, bins), DescribeStatus::Empty);
  const std::vector<std::uint32_t> same(70000, 240 * 640 + 320);
  EXPECT_EQ(describer.describe(image.view(), {same.data(), same.size()}, bins), DescribeStatus::Degenerate);
  EXPECT_EQ(std::accumulate(bins.begin(), bins.end(), 0), 0);
}

TEST(DepthDescriptor, AFewPixelsInALineAreEnough) {
  constexpr std::uint32_t kMiddle = 240 * kWidth + 320;
  const Image image(plate);
  DepthDescriber describer({100, 1});
  DepthBins bins;
  const auto statusOf = [&](const std::vector<std::uint32_t>& pixels) {
    const DescribeStatus status = describer.describe(image.view(), {pixels.data(), pixels.size()}, bins);
    EXPECT_EQ(std::accumulate(bins.begin(), bins.end(), 0) > 0, status == DescribeStatus::Ok);
    return status;
  };
  EXPECT_EQ(statusOf({kMiddle}), DescribeStatus::Degenerate);
  EXPECT_EQ(statusOf({kMiddle, kMiddle + 1}), DescribeStatus::Ok);
  EXPECT_EQ(statusOf({kMiddle, kMiddle + 1, kMiddle + 2}), DescribeStatus::Ok);
  std::vector<std::uint32_t> across, down;
  for (std::uint32_t i = 0; i < 40; ++i) {
    across.push_back(kMiddle + i);
    down.push_back(kMiddle + i * kWidth);
  }
  EXPECT_EQ(statusOf(across), DescribeStatus::Ok);
  EXPECT_EQ(statusOf(down), DescribeStatus::Ok);
}

TEST(DepthDescriptor, AMillionPixelsOfAWallAreFlat) {
  const Image image([](int, int) { return 800; });
  std::vector<std::uint32_t> pixels;
  for (int round = 0; round < 4; ++round) pixels.insert(pixels.end(), image.object().begin(), image.object().end());
  ASSERT_GT(pixels.size(), 1000000u);
  DepthBins bins;
  ASSERT_EQ(DepthDescriber({1000, 1}).describe(image.view(), {pixels.data(), pixels.size()}, bins), DescribeStatus::Ok);
  EXPECT_GT(shareOf(bins, "normal's slope", 31, 31), 0.98);
}

TEST(DepthDescriptor, AnyCameraAndDepthIsBounded) {
  for (const double f_px : {0.001, 3.0, 30000.0}) {
    for (const int step_mm : {0, 1, 60000}) {
      const Image image([&](int u, int v) { return inDisc(u, v, 8) ? 1 + (u % 2) * step_mm + v % 3 : 0; });
      DepthView view = image.view();
      view.camera = Camera::fromPixels(f_px, f_px, -30000, 30000);
      DepthDescriber describer({1000, 1});
      DepthBins bins;
      const DescribeStatus status = describer.describe(view, image.object(), bins);
      EXPECT_TRUE(status == DescribeStatus::Ok || status == DescribeStatus::Degenerate);
    }
  }
}

}  // namespace
}  // namespace voxid
