// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/core/descriptor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <string>
#include <vector>

#include "core/clouds.h"
#include "core/random.h"

namespace voxid {
namespace {

using test::Cloud;
using test::spanOf;

constexpr std::int32_t kLeast = std::numeric_limits<std::int32_t>::min();
constexpr std::int32_t kMost = std::numeric_limits<std::int32_t>::max();
constexpr int kCoarse = 0, kFine = 32, kOn = 160, kOff = 224, kMixed = 288, kRatio = 352;

Described describe(const Cloud& cloud, DescriptorParams params = {}) {
  return Describer(params).describe(spanOf(cloud));
}

std::uint32_t distance(const Descriptor& a, const Descriptor& b) { return l1(a.data(), b.data()); }

// The bins that are not zero, as "bin:value".
std::string nonZero(const Descriptor& d) {
  std::string text;
  for (int i = 0; i < kDescriptorBytes; ++i) {
    if (d[i] != 0) text += (text.empty() ? "" : " ") + std::to_string(i) + ":" + std::to_string(d[i]);
  }
  return text;
}

template <typename Change>
Cloud changed(Cloud cloud, Change change) {
  for (PointUm& p : cloud) p = change(p);
  return cloud;
}

const std::vector<Cloud>& clouds() {
  static const std::vector<Cloud> all{test::sphereCap(), test::boxCorner(), test::mug(), test::ruler()};
  return all;
}

// D = 3.4 x the root mean square distance from the centroid = 1.7 x the distance of two points: bin 128 / 1.7 = 75.
TEST(Descriptor, TwoPointsFillOneBinEach) {
  const Described d = describe({{0, 0, 500000}, {80000, 0, 500000}});
  EXPECT_EQ(d.status, DescribeStatus::Ok);
  EXPECT_EQ(nonZero(d.bins), std::to_string(kCoarse + 75 / 4) + ":255 " + std::to_string(kFine + 75) + ":255 " +
                                 std::to_string(kOff + 75 / 2) + ":255");
}

// Root mean square distance sqrt(2/3) steps, D = 2.776 steps: one step falls into bin 46, two into bin 92. Two thirds
// of the pairs are one step apart: 255 sqrt(2/3) = 208.2; one third: 147.2.
TEST(Descriptor, ThreeCollinearPoints) {
  const Described d = describe({{0, 0, 1}, {0, 1000, 1}, {0, 2000, 1}}, {1000000, 1});
  EXPECT_EQ(d.bins[kFine + 46], 208);
  EXPECT_EQ(d.bins[kFine + 92], 147);
  EXPECT_EQ(d.bins[kCoarse + 11], 208);
  EXPECT_EQ(d.bins[kCoarse + 23], 147);
  EXPECT_EQ(d.bins[kOff + 23], 208);
  EXPECT_EQ(d.bins[kOff + 46], 147);  // three of 46 inner cells are set: less than a fifth
  EXPECT_EQ(std::count_if(d.bins.begin(), d.bins.end(), [](std::uint8_t b) { return b != 0; }), 6);
}

TEST(Descriptor, AFlatPlateIsOnItself) {
  Cloud plate;
  for (int x = 0; x < 50; ++x) {
    for (int y = 0; y < 50; ++y) plate.push_back({x * 2000, y * 2000, 700000});
  }
  const Described d = describe(plate);
  for (int bin = 0; bin < 64; ++bin) {
    EXPECT_EQ(d.bins[kOff + bin], 0);
    EXPECT_EQ(d.bins[kMixed + bin], 0);
    EXPECT_EQ(d.bins[kRatio + bin], 0);
  }
}

// Squares of the bins are shares: each D2 histogram and the three kinds together hold every pair.
TEST(Descriptor, EveryPairIsCountedOnceAPart) {
  for (const Cloud& cloud : clouds()) {
    const Described d = describe(cloud);
    const auto shareOf = [&](int first, int last) {
      double sum = 0;
      for (int i = first; i < last; ++i) sum += d.bins[i] * d.bins[i] / (255.0 * 255.0);
      return sum;
    };
    EXPECT_NEAR(shareOf(kCoarse, kFine), 1, 0.02);
    EXPECT_NEAR(shareOf(kFine, kOn), 1, 0.04);
    EXPECT_NEAR(shareOf(kOn, kRatio), 1, 0.04);
    EXPECT_NEAR(4 * shareOf(kRatio, kDescriptorBytes), shareOf(kMixed, kRatio), 0.06);
  }
}

TEST(Descriptor, RatioHoldsMixedLinesOnly) {
  const Described d = describe(test::boxCorner());
  const auto ratio = [&](int bin) { return int{d.bins[kRatio + bin]}; };
  int set = 0;
  for (int bin = 0; bin < 64; ++bin) set += ratio(bin) != 0;
  EXPECT_GT(set, 20);
  for (int bin = 0; bin <= 11; ++bin) EXPECT_EQ(ratio(bin), 0);  // above 1/5: 12.8
  for (int bin = 52; bin < 64; ++bin) EXPECT_EQ(ratio(bin), 0);  // below 4/5: 51.2
}

TEST(Descriptor, SameInSameOut) {
  for (const Cloud& cloud : clouds()) {
    Describer describer;
    const Described first = describer.describe(spanOf(cloud));
    describer.describe(spanOf(clouds()[0]));
    EXPECT_EQ(describer.describe(spanOf(cloud)).bins, first.bins) << "a call must not leave anything behind";
  }
}

TEST(Descriptor, TranslationChangesNothing) {
  for (const Cloud& cloud : clouds()) {
    const Descriptor there = describe(cloud).bins;
    for (const PointUm t : {PointUm{1, 2, 3}, PointUm{-777777, 31, 1000000000}, PointUm{2000000000, -2000000000, 7}}) {
      EXPECT_EQ(describe(changed(cloud,
                                 [t](PointUm p) {
                                   return PointUm{p.x + t.x, p.y + t.y, p.z + t.z};
                                 }))
                    .bins,
                there);
    }
  }
}

TEST(Descriptor, ScaleHardlyChangesAnything) {
  for (const Cloud& cloud : clouds()) {
    const Descriptor once = describe(cloud).bins;
    for (const int factor : {2, 4, 64}) {
      EXPECT_EQ(describe(changed(cloud,
                                 [=](PointUm p) {
                                   return PointUm{p.x * factor, p.y * factor, p.z * factor};
                                 }))
                    .bins,
                once)
          << factor;
    }
    for (const int factor : {3, 7, 100}) {
      const Cloud larger = changed(cloud, [=](PointUm p) { return PointUm{p.x * factor, p.y * factor, p.z * factor}; });
      EXPECT_LT(distance(describe(larger).bins, once), 60u) << factor;
    }
  }
}

// A quarter turn about an axis permutes the grid's axes: only the rounding of cells and lines may differ.
TEST(Descriptor, AQuarterTurnHardlyChangesAnything) {
  for (const Cloud& cloud : clouds()) {
    const Descriptor once = describe(cloud).bins;
    EXPECT_LT(distance(describe(changed(cloud, [](PointUm p) { return PointUm{p.y, p.z, p.x}; })).bins, once), 500u);
    EXPECT_LT(distance(describe(changed(cloud, [](PointUm p) { return PointUm{-p.y, p.x, p.z}; })).bins, once), 900u);
  }
}

TEST(Descriptor, DoubledPointsGiveNearlyTheSame) {
  for (const Cloud& cloud : clouds()) {
    Cloud doubled = cloud;
    doubled.insert(doubled.end(), cloud.begin(), cloud.end());
    const std::uint32_t noise = distance(describe(cloud, {10000, 2}).bins, describe(cloud, {10000, 3}).bins);
    EXPECT_LT(distance(describe(doubled).bins, describe(cloud).bins), noise * 3 / 2);
  }
}

TEST(Descriptor, DifferentThingsLieFartherApartThanNoise) {
  for (std::size_t i = 0; i < clouds().size(); ++i) {
    const Descriptor own = describe(clouds()[i]).bins;
    const std::uint32_t noise = distance(own, describe(clouds()[i], {10000, 2}).bins);
    EXPECT_GT(noise, 0u) << "the seed must matter";
    for (std::size_t k = 0; k < i; ++k) EXPECT_GT(distance(own, describe(clouds()[k]).bins), noise * 3 / 2);
  }
}

TEST(Descriptor, TooFewPointsHaveAStatus) {
  EXPECT_EQ(describe({}).status, DescribeStatus::Empty);
  EXPECT_EQ(describe({{1, 2, 3}}).status, DescribeStatus::Degenerate);
  EXPECT_EQ(describe(Cloud(5000, PointUm{1, 2, 3})).status, DescribeStatus::Degenerate);
  EXPECT_EQ(describe(Cloud(5000, PointUm{1, 2, 3})).bins, Descriptor{});
  EXPECT_EQ(describe({{kLeast, kLeast, kLeast}}).status, DescribeStatus::Degenerate);
  EXPECT_STREQ(nameOf(DescribeStatus::Ok), "OK");
  EXPECT_STREQ(nameOf(DescribeStatus::Empty), "EMPTY");
  EXPECT_STREQ(nameOf(DescribeStatus::Degenerate), "DEGENERATE");
}

// One grain of difference is enough for a descriptor, the whole int32 range not too much.
TEST(Descriptor, ExtremesGiveTheSameAsTheirSmallTwins) {
  const Descriptor two = describe({{0, 0, 0}, {1, 1, 1}}).bins;
  EXPECT_EQ(describe({{5, 5, 5}, {6, 6, 6}}).bins, two);
  EXPECT_EQ(describe({{kLeast, kLeast, kLeast}, {kMost, kMost, kMost}}).bins, two);
  EXPECT_EQ(describe({{kMost, kMost, kMost}, {kMost - 1, kMost - 1, kMost - 1}}).bins, two);
  Cloud corners;
  for (int i = 0; i < 8; ++i)
    corners.push_back({i & 1 ? kMost : kLeast, i & 2 ? kMost : kLeast, i & 4 ? kMost : kLeast});
  Cloud small;
  for (int i = 0; i < 8; ++i) small.push_back({i & 1, i >> 1 & 1, i >> 2 & 1});
  EXPECT_EQ(describe(corners).bins, describe(small).bins);
}

TEST(Descriptor, CoplanarAndCollinearCloudsAreDescribed) {
  Cloud line, plane;
  for (int i = 0; i < 500; ++i) {
    line.push_back({i, 2 * i, 3 * i});
    plane.push_back({i % 20, i / 20, i % 20 + i / 20});
  }
  EXPECT_EQ(describe(line).status, DescribeStatus::Ok);
  EXPECT_EQ(describe(plane).status, DescribeStatus::Ok);
}

// One point that flies far: distances of the others stay apart from it, and what lies beyond 4 D is clamped.
TEST(Descriptor, AFlyingPointIsBounded) {
  Cloud cloud(65535, PointUm{0, 0, 0});
  for (std::size_t i = 0; i < cloud.size(); ++i) cloud[i] = {static_cast<std::int32_t>(i % 200), 0, 0};
  cloud.push_back({kMost, kMost, kMost});
  const Described d = describe(cloud);
  EXPECT_EQ(d.status, DescribeStatus::Ok);
  EXPECT_GE(d.bins[kFine], 254);
}

TEST(Descriptor, MillionsOfPointsAreChosenEvenly) {
  Cloud many;
  test::Random random(5);
  for (int i = 0; i < 1000000; ++i) many.push_back({random.below(100000), random.below(60000), random.below(30000)});
  Cloud chosen;
  for (std::uint64_t i = 0; i < 65536; ++i) chosen.push_back(many[i * many.size() / 65536]);
  EXPECT_EQ(describe(many).bins, describe(chosen).bins);
}

TEST(Descriptor, RandomCloudsOfAnySizeAndSpreadAreDescribed) {
  test::Random random(6);
  Describer describer({500, 1});
  for (int round = 0; round < 2000; ++round) {
    const int shift_x = random.below(32), shift_y = random.below(32), shift_z = random.below(32);
    Cloud cloud;
    for (int n = random.between(2, 40); n > 0; --n) {
      cloud.push_back({static_cast<std::int32_t>(random.bits()) >> shift_x,
                       static_cast<std::int32_t>(random.bits()) >> shift_y,
                       static_cast<std::int32_t>(random.bits()) >> shift_z});
    }
    const Described d = describer.describe(spanOf(cloud));
    const int coarse = std::accumulate(d.bins.begin(), d.bins.begin() + kFine, 0);
    ASSERT_NE(d.status, DescribeStatus::Empty) << round;
    ASSERT_EQ(coarse >= 255, d.status == DescribeStatus::Ok) << round;
  }
}

TEST(Descriptor, PairsAreClampedToTheirRange) {
  EXPECT_EQ(Describer({0, 1}).params().pairs, 1u);
  EXPECT_EQ(Describer({0xffffffff, 1}).params().pairs, kMaxPairs);
  EXPECT_EQ(Describer().params().pairs, 10000u);
}

struct DepthImage {
  static constexpr int kWidth = 60, kHeight = 40;
  std::vector<std::uint16_t> mm = std::vector<std::uint16_t>(kWidth * kHeight);
  DepthView view() const {
    return {mm.data(), kWidth, kHeight, kWidth * 2, DepthUnit::MillimetreU16, Camera::fromPixels(525, 525, 30, 20)};
  }
};

DepthImage bowl() {
  DepthImage image;
  for (int i = 0; i < DepthImage::kWidth * DepthImage::kHeight; ++i) {
    const int u = i % DepthImage::kWidth - 30, v = i / DepthImage::kWidth - 20;
    image.mm[i] = static_cast<std::uint16_t>((u * 7 + v * 3) % 11 == 0 ? 0 : 700 + (u * u + v * v) / 20);
  }
  return image;
}

TEST(Descriptor, OfPixelsIsThatOfTheirPoints) {
  const DepthImage image = bowl();
  std::vector<std::uint32_t> pixels;
  Cloud cloud;
  for (std::uint32_t i = 0; i < image.mm.size(); i += 2) {
    pixels.push_back(i);
    const int u = static_cast<int>(i) % DepthImage::kWidth, v = static_cast<int>(i) / DepthImage::kWidth;
    if (image.mm[i] != 0) cloud.push_back(backProject(image.view().camera, u, v, image.mm[i] * 1000));
  }
  for (const std::uint32_t outside : {2400u, 2401u, 0xffffffffu}) pixels.push_back(outside);
  ASSERT_LT(cloud.size(), pixels.size() - 3) << "some pixels have no depth";
  const Described found = Describer().describe(image.view(), {pixels.data(), pixels.size()});
  EXPECT_EQ(found.status, DescribeStatus::Ok);
  EXPECT_EQ(found.bins, describe(cloud).bins);
}

TEST(Descriptor, OfManyPixelsChoosesLikePoints) {
  const DepthImage image = bowl();
  std::vector<std::uint32_t> pixels;
  Cloud cloud;
  for (std::uint32_t i = 0; i < 100000; ++i) {
    const std::uint32_t pixel = i * 7 % static_cast<std::uint32_t>(image.mm.size());
    pixels.push_back(pixel);
    const int u = static_cast<int>(pixel) % DepthImage::kWidth, v = static_cast<int>(pixel) / DepthImage::kWidth;
    if (image.mm[pixel] != 0) cloud.push_back(backProject(image.view().camera, u, v, image.mm[pixel] * 1000));
  }
  ASSERT_GT(cloud.size(), 65536u);
  EXPECT_EQ(Describer().describe(image.view(), {pixels.data(), pixels.size()}).bins, describe(cloud).bins);
}

TEST(Descriptor, OfNoDepthIsEmpty) {
  DepthImage image;
  const std::vector<std::uint32_t> pixels{0, 1, 2, 3};
  const Span<const std::uint32_t> all{pixels.data(), pixels.size()};
  EXPECT_EQ(Describer().describe(image.view(), all).status, DescribeStatus::Empty);
  EXPECT_EQ(Describer().describe(DepthView{}, all).status, DescribeStatus::Empty);
  image.mm.assign(image.mm.size(), 800);
  DepthView no_camera = image.view();
  no_camera.camera = {};
  EXPECT_EQ(Describer().describe(no_camera, all).status, DescribeStatus::Empty);
  EXPECT_EQ(Describer().describe(image.view(), {}).status, DescribeStatus::Empty);
  EXPECT_EQ(Describer().describe(image.view(), all).status, DescribeStatus::Ok);
}

TEST(L1, SumsDifferences) {
  Descriptor a{}, b{};
  EXPECT_EQ(distance(a, b), 0u);
  a.fill(255);
  EXPECT_EQ(distance(a, b), 106080u);
  EXPECT_EQ(distance(b, a), 106080u);
  b.fill(250);
  b[415] = 0;
  EXPECT_EQ(distance(a, b), 415u * 5 + 255);
}

}  // namespace
}  // namespace voxid
