// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/core/grid.h"

#include <gtest/gtest.h>

#include <memory>

#include "core/random.h"

namespace voxid {
namespace {

constexpr int kSide = VoxelGrid::kSide;

Cell cell(int x, int y, int z) {
  return {static_cast<std::uint8_t>(x), static_cast<std::uint8_t>(y), static_cast<std::uint8_t>(z)};
}

bool inside(int i) { return i >= 0 && i < kSide; }

// Cell by cell as the definition says, in three loops over the 27 cells around each; the border counts as `outside`.
template <typename Combine>
VoxelGrid around(const VoxelGrid& grid, Combine combine) {
  VoxelGrid out;
  for (int z = 0; z < kSide; ++z) {
    for (int y = 0; y < kSide; ++y) {
      for (int x = 0; x < kSide; ++x) {
        if (combine(grid, x, y, z)) out.set(cell(x, y, z));
      }
    }
  }
  return out;
}

int setAround(const VoxelGrid& grid, int x, int y, int z, int outside) {
  int set = 0;
  for (int k = 0; k < 27; ++k) {
    const int nx = x + k % 3 - 1, ny = y + k / 3 % 3 - 1, nz = z + k / 9 - 1;
    set += inside(nx) && inside(ny) && inside(nz) ? grid.test(cell(nx, ny, nz)) : outside;
  }
  return set;
}

VoxelGrid closedSlowly(const VoxelGrid& grid) {
  const VoxelGrid dilated =
      around(grid, [](const VoxelGrid& g, int x, int y, int z) { return setAround(g, x, y, z, 0) > 0; });
  const VoxelGrid eroded =
      around(dilated, [](const VoxelGrid& g, int x, int y, int z) { return setAround(g, x, y, z, 1) == 27; });
  return around(grid, [&](const VoxelGrid& g, int x, int y, int z) {
    return g.test(cell(x, y, z)) || eroded.test(cell(x, y, z));
  });
}

TEST(VoxelGrid, SetsAndCountsCells) {
  VoxelGrid grid;
  EXPECT_EQ(grid.count(), 0);
  for (const Cell c : {cell(0, 0, 0), cell(63, 63, 63), cell(5, 6, 7), cell(5, 6, 7)}) grid.set(c);
  EXPECT_EQ(grid.count(), 3);
  EXPECT_TRUE(grid.test(cell(5, 6, 7)));
  EXPECT_FALSE(grid.test(cell(7, 6, 5)));
  EXPECT_EQ(grid.rows()[7 * 64 + 6], std::uint64_t{1} << 5);
  grid.clear();
  EXPECT_EQ(grid.count(), 0);
}

TEST(VoxelGrid, ThickeningAddsTheSixNeighbours) {
  for (const Cell c : {cell(0, 0, 0), cell(63, 63, 63), cell(63, 0, 31), cell(30, 31, 32)}) {
    VoxelGrid grid, expected;
    grid.set(c);
    grid.thicken();
    for (int k = 0; k < 27; ++k) {
      const int dx = k % 3 - 1, dy = k / 3 % 3 - 1, dz = k / 9 - 1;
      const bool near = dx * dx + dy * dy + dz * dz <= 1;
      if (near && inside(c.x + dx) && inside(c.y + dy) && inside(c.z + dz))
        expected.set(cell(c.x + dx, c.y + dy, c.z + dz));
    }
    EXPECT_EQ(grid.rows(), expected.rows());
  }
}

TEST(VoxelGrid, ClosingBridgesGapsOfTwoCellsAndNoMore) {
  VoxelGrid grid;
  for (int y = 10; y < 30; ++y) {
    for (int z = 10; z < 30; ++z) {
      for (const int x : {20, 23, 27}) grid.set(cell(x, y, z));
    }
  }
  grid.close();
  EXPECT_TRUE(grid.test(cell(21, 20, 20)));
  EXPECT_TRUE(grid.test(cell(22, 20, 20)));
  EXPECT_FALSE(grid.test(cell(24, 20, 20)));
  EXPECT_FALSE(grid.test(cell(25, 20, 20)));
  EXPECT_FALSE(grid.test(cell(26, 20, 20)));
}

TEST(VoxelGrid, ClosingLeavesASingleCellAlone) {
  for (const Cell c : {cell(0, 0, 0), cell(63, 0, 31), cell(30, 30, 30)}) {
    VoxelGrid grid;
    grid.set(c);
    grid.close();
    EXPECT_TRUE(grid.test(c));
    EXPECT_EQ(grid.count(), 1);
  }
}

TEST(VoxelGrid, ClosingIsTheDefinitionOnRandomGrids) {
  for (const int cells : {1, 300, 5000, 60000}) {
    test::Random random(static_cast<std::uint64_t>(cells));
    VoxelGrid grid;
    for (int i = 0; i < cells; ++i) grid.set(cell(random.below(64), random.below(64), random.below(64)));
    const VoxelGrid expected = closedSlowly(grid);
    grid.close();
    EXPECT_EQ(grid.rows(), expected.rows()) << cells;
  }
}

TEST(VoxelGrid, ClosingIsTheDefinitionAtTheBorder) {
  VoxelGrid grid;
  test::Random random(7);
  for (int i = 0; i < 3000; ++i) grid.set(cell(random.below(3) * 31, random.below(64), random.below(2) * 63));
  const VoxelGrid expected = closedSlowly(grid);
  grid.close();
  EXPECT_EQ(grid.rows(), expected.rows());
}

}  // namespace
}  // namespace voxid
