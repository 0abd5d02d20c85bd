// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/core/trace.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <tuple>
#include <vector>

#include "core/random.h"

namespace voxid {
namespace {

Cell cell(int x, int y, int z) {
  return {static_cast<std::uint8_t>(x), static_cast<std::uint8_t>(y), static_cast<std::uint8_t>(z)};
}

// The textbook's 3D Bresenham with error terms, from the end that comes first in (z, y, x).
std::vector<Cell> innerCells(Cell a, Cell b) {
  if (std::tie(b.z, b.y, b.x) < std::tie(a.z, a.y, a.x)) std::swap(a, b);
  const std::array<int, 3> from{a.x, a.y, a.z}, to{b.x, b.y, b.z};
  std::array<int, 3> at = from, length{}, error{};
  for (int axis = 0; axis < 3; ++axis) length[axis] = std::abs(to[axis] - from[axis]);
  const int steps = std::max({length[0], length[1], length[2]});
  for (int axis = 0; axis < 3; ++axis) error[axis] = 2 * length[axis] - steps;
  std::vector<Cell> cells;
  for (int i = 1; i < steps; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      if (error[axis] >= 0) {
        at[axis] += to[axis] > from[axis] ? 1 : -1;
        error[axis] -= 2 * steps;
      }
      error[axis] += 2 * length[axis];
    }
    cells.push_back(cell(at[0], at[1], at[2]));
  }
  return cells;
}

Trace walkSlowly(const VoxelGrid& surface, Cell a, Cell b) {
  const std::vector<Cell> cells = innerCells(a, b);
  const auto on = std::count_if(cells.begin(), cells.end(), [&](Cell c) { return surface.test(c); });
  return {static_cast<std::uint8_t>(cells.size()), static_cast<std::uint8_t>(on)};
}

VoxelGrid randomGrid(int cells, std::uint64_t seed) {
  VoxelGrid grid;
  test::Random random(seed);
  for (int i = 0; i < cells; ++i) grid.set(cell(random.below(64), random.below(64), random.below(64)));
  return grid;
}

void expectSameWalk(const VoxelGrid& grid, Cell a, Cell b) {
  const Trace expected = walkSlowly(grid, a, b), found = walk(grid, a, b), back = walk(grid, b, a);
  ASSERT_EQ(found.inner, expected.inner);
  ASSERT_EQ(found.on, expected.on) << int{a.x} << "," << int{a.y} << "," << int{a.z} << " to " << int{b.x} << ","
                                   << int{b.y} << "," << int{b.z};
  ASSERT_EQ(back.inner, found.inner);
  ASSERT_EQ(back.on, found.on);
}

TEST(Walk, CountsInnerCellsOnly) {
  VoxelGrid grid;
  for (int x = 3; x <= 9; ++x) grid.set(cell(x, 20, 40));
  const Trace line = walk(grid, cell(3, 20, 40), cell(12, 20, 40));
  EXPECT_EQ(line.inner, 8);
  EXPECT_EQ(line.on, 6);  // 4 to 9
  EXPECT_EQ(walk(grid, cell(3, 20, 40), cell(4, 21, 41)).inner, 0);
  EXPECT_EQ(walk(grid, cell(3, 20, 40), cell(3, 20, 40)).inner, 0);
  EXPECT_EQ(walk(grid, cell(0, 0, 0), cell(63, 63, 63)).inner, 62);
}

TEST(Walk, EqualsTheReferenceOnRandomLines) {
  const VoxelGrid grid = randomGrid(100000, 1);
  test::Random random(2);
  for (int i = 0; i < 50000; ++i) {
    const Cell a = cell(random.below(64), random.below(64), random.below(64));
    ASSERT_NO_FATAL_FAILURE(expectSameWalk(grid, a, cell(random.below(64), random.below(64), random.below(64))));
  }
}

// Every slope in a plane, up and down: all the halves that rounding must decide. Each inner cell is asked for alone, so
// that no two errors can cancel.
TEST(Walk, VisitsTheReferencesCellsForEverySlope) {
  for (int steps = 1; steps < 64; ++steps) {
    for (int rise = 0; rise <= steps; ++rise) {
      for (const bool down : {false, true}) {
        const Cell a = cell(down ? rise : 0, 5, 0), b = cell(down ? 0 : rise, 5, steps);
        VoxelGrid grid;
        for (const Cell c : innerCells(a, b)) grid.set(c);
        ASSERT_EQ(walk(grid, a, b).on, steps - 1) << rise << " in " << steps;
      }
    }
  }
}

TEST(Walk, IsTheSameAlongEveryAxisOrder) {
  const VoxelGrid grid = randomGrid(60000, 3);
  test::Random random(4);
  for (int i = 0; i < 2000; ++i) {
    const int n = random.between(1, 63), d = random.below(64), e = random.below(64);
    ASSERT_NO_FATAL_FAILURE(expectSameWalk(grid, cell(0, d, 63), cell(n, e, 0)));
    ASSERT_NO_FATAL_FAILURE(expectSameWalk(grid, cell(d, 0, e), cell(e, n, d)));
    ASSERT_NO_FATAL_FAILURE(expectSameWalk(grid, cell(63, e, 0), cell(0, d, n)));
  }
}

TEST(KindOf, ToleratesAFifth) {
  EXPECT_EQ(kindOf({0, 0}), LineKind::On);
  EXPECT_EQ(kindOf({1, 1}), LineKind::On);
  EXPECT_EQ(kindOf({1, 0}), LineKind::Off);
  EXPECT_EQ(kindOf({10, 8}), LineKind::On);
  EXPECT_EQ(kindOf({10, 7}), LineKind::Mixed);
  EXPECT_EQ(kindOf({10, 3}), LineKind::Mixed);
  EXPECT_EQ(kindOf({10, 2}), LineKind::Off);
  EXPECT_EQ(kindOf({62, 50}), LineKind::On);
  EXPECT_EQ(kindOf({62, 49}), LineKind::Mixed);
  EXPECT_EQ(kindOf({62, 12}), LineKind::Off);
}

}  // namespace
}  // namespace voxid
