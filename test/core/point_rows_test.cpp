// SPDX-License-Identifier: BSD-3-Clause
#include "../../src/core/point_rows.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/random.h"

namespace voxid {
namespace {

using test::Random;

std::vector<std::int32_t> numbers(std::size_t size, int below, std::uint32_t seed) {
  Random random(seed);
  std::vector<std::int32_t> row(size);
  for (std::int32_t& number : row) number = random.below(below);
  return row;
}

TEST(PointRows, GiveTheLeastAndTheMost) {
  for (std::size_t size = 1; size < 70; ++size) {
    std::vector<std::int32_t> row = numbers(size, 1000, 3);
    row[size / 2] = std::numeric_limits<std::int32_t>::min();
    row[size - 1] = std::numeric_limits<std::int32_t>::max();
    const Range range = rangeOf(row.data(), size);
    EXPECT_EQ(range.least, *std::min_element(row.begin(), row.end()));
    EXPECT_EQ(range.most, *std::max_element(row.begin(), row.end()));
  }
}

TEST(PointRows, GiveSumsOfTheLargestNumbers) {
  const std::vector<std::int32_t> row(kMaxPoints, (1 << 20) - 1);
  const Moments moments = momentsOf(row.data(), row.size());
  EXPECT_EQ(moments.sum, 65536 * std::int64_t{1048575});
  EXPECT_EQ(moments.squares, 65536 * std::int64_t{1048575} * 1048575);
}

TEST(PointRows, AreShiftedFromACornerAtTheLimits) {
  constexpr std::int32_t kLeast = std::numeric_limits<std::int32_t>::min(),
                         kMost = std::numeric_limits<std::int32_t>::max();
  std::vector<std::int32_t> row{kLeast, -1, 0, kMost};
  shiftRow(row.data(), row.size(), kLeast, 0, 12);
  EXPECT_EQ(row, (std::vector<std::int32_t>{0, 0x7ffff, 0x80000, 0xfffff}));
  std::vector<std::int32_t> near{kMost - 1, kMost};
  shiftRow(near.data(), near.size(), kMost - 1, 19, 0);
  EXPECT_EQ(near, (std::vector<std::int32_t>{0, 1 << 19}));
}

TEST(BackProjector, AgreesWithTheDivisionForAnyCamera) {
  Random random(5);
  const auto number = [&] { return static_cast<std::int32_t>(random.bits()); };
  for (int i = 0; i < 200000; ++i) {
    Camera camera{number() & INT32_MAX, number() & INT32_MAX, number(), number()};
    camera.fx_q16 = std::max(camera.fx_q16 >> (i % 31), 1);
    camera.fy_q16 = std::max(camera.fy_q16 >> (i % 29), 1);
    const int u = number() % 40000, v = number() % 40000;
    const std::int32_t z_um = number() >> (i % 13);
    const PointUm point = BackProjector(camera).point(u, v, z_um), divided = backProject(camera, u, v, z_um);
    ASSERT_EQ(point.x, divided.x) << camera.fx_q16 << ' ' << camera.cx_q16 << ' ' << u << ' ' << z_um;
    ASSERT_EQ(point.y, divided.y) << camera.fy_q16 << ' ' << camera.cy_q16 << ' ' << v << ' ' << z_um;
  }
}

TEST(BackProjector, RoundsHalfAwayFromZeroAsTheDivisionDoes) {
  const Camera camera{2 * 65536, 3 * 65536, 0, 0};
  for (int u = -50; u <= 50; ++u) {
    const PointUm point = BackProjector(camera).point(u, u, 1), divided = backProject(camera, u, u, 1);
    EXPECT_EQ(point.x, divided.x) << u;
    EXPECT_EQ(point.y, divided.y) << u;
  }
}

}  // namespace
}  // namespace voxid
