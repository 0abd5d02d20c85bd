// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/library/discriminants.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "../../src/library/random.h"

namespace voxid {
namespace {

constexpr int kBins = 8;

/// Categories differ in the first two bins, by 40; every bin has noise.
void takeViews(const TakeView& take) {
  Random random(5);
  const std::uint8_t middles[3][2] = {{100, 100}, {140, 100}, {100, 140}};
  for (int view = 0; view < 600; ++view) {
    const int category = view % 3;
    std::uint8_t bins[kBins];
    for (std::uint8_t& bin : bins) bin = static_cast<std::uint8_t>(100 + random.below(9) - 4);
    for (int i = 0; i < 2; ++i) bins[i] = static_cast<std::uint8_t>(bins[i] + middles[category][i] - 100);
    take(std::string(1, static_cast<char>('a' + category)), bins);
  }
}

std::vector<std::int8_t> rowOf(const IntegerMap& map, int row) {
  return {map.matrix.begin() + row * kBins, map.matrix.begin() + (row + 1) * kBins};
}

TEST(Discriminants, LookWhereCategoriesDiffer) {
  const IntegerMap map = learnDiscriminants(takeViews, kBins, 2, 0.03);
  for (int row = 0; row < 2; ++row) {
    const std::vector<std::int8_t> entries = rowOf(map, row);
    EXPECT_EQ(std::max(std::abs(entries[0]), std::abs(entries[1])), 127) << row;
    for (int bin = 2; bin < kBins; ++bin) EXPECT_LT(std::abs(entries[static_cast<std::size_t>(bin)]), 20) << row;
  }
}

TEST(Discriminants, OfFewCategoriesComeAgain) {
  const IntegerMap map = learnDiscriminants(takeViews, kBins, 7, 0.03);
  for (int row = 0; row < 7; ++row) {
    EXPECT_EQ(rowOf(map, row), rowOf(map, row % 2)) << row;
    EXPECT_EQ(map.bias[static_cast<std::size_t>(row)], map.bias[static_cast<std::size_t>(row % 2)]);
    EXPECT_EQ(map.factor_q24[static_cast<std::size_t>(row)], map.factor_q24[static_cast<std::size_t>(row % 2)]);
  }
  EXPECT_NE(rowOf(map, 0), rowOf(map, 1));
}

TEST(Discriminants, OfOneCategoryAreNone) {
  const auto one = [](const TakeView& take) {
    takeViews([&](const std::string&, const std::uint8_t* bins) { take("a", bins); });
  };
  const IntegerMap map = learnDiscriminants(one, kBins, 3, 0.03);
  EXPECT_TRUE(std::all_of(map.matrix.begin(), map.matrix.end(), [](std::int8_t entry) { return entry == 0; }));
}

}  // namespace
}  // namespace voxid
