// SPDX-License-Identifier: BSD-3-Clause
// Lines walked in step count what walk(), the definition, counts for each alone.
#include "../../src/core/line_walker.h"

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "core/random.h"
#include "voxid/core/trace.h"

namespace voxid {
namespace {

Cell cell(int x, int y, int z) {
  return {static_cast<std::uint8_t>(x), static_cast<std::uint8_t>(y), static_cast<std::uint8_t>(z)};
}

struct Line {
  Cell a, b;
};

void expectSameWalks(LineWalker& walker, const VoxelGrid& grid, const std::vector<Line>& lines) {
  walker.see(grid);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    walker.from[i] = orderOf(lines[i].a);
    walker.to[i] = orderOf(lines[i].b);
  }
  walker.walk(lines.size());
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const Trace expected = walk(grid, lines[i].a, lines[i].b);
    ASSERT_EQ(walker.inner[i], expected.inner) << i << " of " << lines.size();
    ASSERT_EQ(walker.on[i], expected.on) << i << " of " << lines.size();
  }
}

class LineWalkerTest : public ::testing::Test {
 protected:
  Cell randomCell() { return cell(random_.below(64), random_.below(64), random_.below(64)); }

  test::Random random_{1};
  std::unique_ptr<LineWalker> walker_ = std::make_unique<LineWalker>();
};

TEST_F(LineWalkerTest, EqualsTheDefinitionInBatchesOfAnySize) {
  VoxelGrid grid;
  for (int i = 0; i < 100000; ++i) grid.set(randomCell());
  for (const std::size_t size : {std::size_t{1}, std::size_t{15}, std::size_t{16}, std::size_t{17},
                                 LineWalker::kLines - 1, LineWalker::kLines, LineWalker::kLines}) {
    std::vector<Line> lines(size);
    for (Line& line : lines) line = {randomCell(), randomCell()};
    ASSERT_NO_FATAL_FAILURE(expectSameWalks(*walker_, grid, lines));
  }
}

// Every slope in every plane, up and down: all the halves that rounding must decide. The other cells of a line's own
// rows are unset, so that no two errors can cancel.
TEST_F(LineWalkerTest, VisitsTheDefinitionsCellsForEverySlope) {
  for (int steps = 1; steps < 64; ++steps) {
    for (int rise = 0; rise <= steps; ++rise) {
      const Cell a = cell(rise, 5, 0), b = cell(0, 5, steps);
      VoxelGrid even;
      for (int x = 0; x < 64; x += 2) {
        for (int z = 0; z < 64; ++z) even.set(cell(x, 5, z)), even.set(cell(5, x, z)), even.set(cell(z, x, 5));
      }
      ASSERT_NO_FATAL_FAILURE(expectSameWalks(*walker_, even,
                                              {{a, b},
                                               {b, a},
                                               {cell(0, 5, 0), cell(rise, 5, steps)},
                                               {cell(5, 0, 0), cell(5, rise, steps)},
                                               {cell(5, rise, 0), cell(5, 0, steps)},
                                               {cell(0, 0, 5), cell(steps, rise, 5)},
                                               {cell(0, rise, 5), cell(steps, 0, 5)}}));
    }
  }
}

}  // namespace
}  // namespace voxid
