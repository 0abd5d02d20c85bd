// SPDX-License-Identifier: BSD-3-Clause
#include "enclosure.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace voxid {
namespace {

using Walls = std::array<std::uint8_t, 2>;

/// A picture of 64 columns. Digits are pieces, '.' is depth of none, ' ' no depth. All lie a metre away, but `far`
/// ones.
struct Picture {
  InverseDepth inverse;
  std::vector<std::uint8_t> pieces;

  explicit Picture(const std::vector<std::string>& rows, char far = 0, double far_m = 1) {
    inverse.width_px = 64;
    inverse.height_px = static_cast<int>(rows.size());
    for (std::string row : rows) {
      row.resize(64, '.');
      for (const char c : row) {
        pieces.push_back(static_cast<std::uint8_t>(c >= '1' && c <= '9' ? c - '0' : 0));
        inverse.values.push_back(c == ' ' ? 0 : static_cast<std::int32_t>(256000 / (c == far ? far_m : 1)));
      }
    }
  }

  Enclosure of(std::uint8_t piece) const {
    std::vector<Run> runs;
    for (std::uint32_t i = 0; i < pieces.size(); ++i) {
      if (pieces[i] != piece) continue;
      if (!runs.empty() && runs.back().end == i && i % 64 != 0)
        ++runs.back().end;
      else
        runs.push_back({i, i + 1});
    }
    return {inverse, pieces.data(), {runs.data(), runs.size()}, piece};
  }
};

TEST(Enclosure, WhatIsRingedFacesNothingElse) {
  const Picture ring({"22222222", "22111122", "22111122", "22222222"});
  EXPECT_EQ(ring.of(1).walls(), (Walls{2, 0}));
  EXPECT_EQ(ring.of(1).percent(), 100);
  EXPECT_EQ(ring.of(2).percent(), 0);
}

TEST(Enclosure, TwoWallsAreTakenInTheOrderOfTheirShares) {
  const Enclosure between = Picture({"22222222", "22111122", "22111122", "33333333"}).of(1);
  EXPECT_EQ(between.walls(), (Walls{2, 3}));
  EXPECT_EQ(between.percent(), 66 + 33);
}

TEST(Enclosure, MissingDepthInBetweenDoesNotCountButDepthDoes) {
  EXPECT_EQ(Picture({"2222222222", "2  1111  2", "2  1111  2", "2222222222"}).of(1).percent(), 100);
  const Enclosure apart =
      Picture({"222222222222222222", "2.....1111.......2", "2.....1111.......2", "222222222222222222"}).of(1);
  EXPECT_EQ(apart.percent(), 0) << "five pixels of table to either side";
}

TEST(Enclosure, WhatLiesAStepBehindIsNoWall) {
  const std::vector<std::string> rows{"22222222", "22111122", "22111122", "22222222"};
  EXPECT_EQ(Picture(rows, '2', 1.01).of(1).percent(), 100);
  EXPECT_EQ(Picture(rows, '2', 1.03).of(1).percent(), 0);
  EXPECT_EQ(Picture(rows, '2', 0.9).of(1).percent(), 100) << "what lies before it may be";
}

TEST(Enclosure, BeyondTheImageThereIsNothing) {
  EXPECT_EQ(Picture({"11222222", "11222222"}).of(1).percent(), 25) << "two ends of its rows of eight ends";
  EXPECT_EQ(Picture({"22111122", "22111122"}).of(1).percent(), 33) << "all ends of its rows, none of its columns'";
}

}  // namespace
}  // namespace voxid
