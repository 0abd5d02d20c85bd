// SPDX-License-Identifier: BSD-3-Clause
#include "observation.h"

#include <gtest/gtest.h>

#include "core/random.h"

namespace voxid {
namespace {

/// An image of one depth, and some of its pixels.
struct Patches {
  static constexpr int kWidth = 97, kHeight = 61;
  std::vector<std::uint16_t> depth_mm = std::vector<std::uint16_t>(kWidth * kHeight, 800);
  std::vector<std::uint32_t> pixels;

  explicit Patches(test::Random& random) {
    std::vector<bool> set(depth_mm.size());
    for (int patch = 0; patch < 6; ++patch) {
      const int u = random.below(kWidth - 20), v = random.below(kHeight - 15);
      const int width = random.between(1, 20), height = random.between(1, 15);
      for (int y = v; y < v + height; ++y)
        for (int x = u; x < u + width; ++x) set[static_cast<std::size_t>(y * kWidth + x)] = random.below(9) > 0;
    }
    for (std::uint32_t i = 0; i < set.size(); ++i)
      if (set[i]) pixels.push_back(i);
  }
  ObservedObject object() const {
    ObservedObject object;
    object.depth.data = reinterpret_cast<const std::uint8_t*>(depth_mm.data());
    object.depth.width_px = kWidth, object.depth.height_px = kHeight, object.depth.row_bytes = 2 * kWidth;
    object.depth.unit = DepthUnit::MillimetreU16;
    object.depth.camera = Camera::fromPixels(80, 80, kWidth / 2.0, kHeight / 2.0);
    object.pixels = {pixels.data(), pixels.size()};
    return object;
  }
};

int squaredBetween(const PixelGrid& grid, std::size_t a, int b) {
  const auto to = static_cast<std::size_t>(b);
  const int du = grid.columnOf(a) - grid.columnOf(to), dv = grid.rowOf(a) - grid.rowOf(to);
  return du * du + dv * dv;
}

// nearestSet looks at all cells about one: the definition.
TEST(Observation, EveryCellOutsideKnowsItsNearestInside) {
  test::Random random(3);
  for (int trial = 0; trial < 30; ++trial) {
    const Patches patches(random);
    Observation seen;
    observe(patches.object(), random.between(50, 2000), seen);
    for (std::size_t cell = 0; cell < seen.grid.size(); ++cell) {
      const int found = seen.nearest[cell];
      if (seen.object[cell]) {
        ASSERT_EQ(found, -1);
        continue;
      }
      const int expected = nearestSet(seen.grid, cell, [&](std::size_t c) { return seen.object[c] != 0; });
      ASSERT_EQ(found < 0, expected < 0) << "trial " << trial << " cell " << cell;
      if (found < 0) continue;
      ASSERT_TRUE(seen.object[static_cast<std::size_t>(found)]);
      ASSERT_EQ(squaredBetween(seen.grid, cell, found), squaredBetween(seen.grid, cell, expected));
    }
  }
}

}  // namespace
}  // namespace voxid
