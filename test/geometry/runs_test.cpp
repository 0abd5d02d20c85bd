// SPDX-License-Identifier: BSD-3-Clause
#include "runs.h"

#include <gtest/gtest.h>

#include <random>
#include <set>
#include <vector>

namespace voxid {
namespace {

constexpr std::uint32_t kWidth = 50, kHeight = 40;

/// Some of an image's pixels, and the same as runs; what touches may be two runs.
struct RandomRuns {
  std::set<std::uint32_t> pixels;
  std::vector<Run> runs;

  explicit RandomRuns(unsigned gaps_per_256) {
    std::mt19937 random(11);
    for (std::uint32_t pixel = 0; pixel < kWidth * kHeight; ++pixel) {
      if (random() % 256 < gaps_per_256) continue;
      pixels.insert(pixel);
      const bool goes_on = !runs.empty() && runs.back().end == pixel && pixel % kWidth != 0 && random() % 8 != 0;
      if (goes_on)
        ++runs.back().end;
      else
        runs.push_back({pixel, pixel + 1});
    }
  }
};

std::set<std::uint32_t> uncovered(const std::vector<Run>& runs, int shift) {
  std::set<std::uint32_t> visited;
  const Run *other = runs.data(), *const end = other + runs.size();
  for (const Run& run : runs) {
    visitUncovered(run, shift, other, end, [&](std::uint32_t first, std::uint32_t last) {
      for (std::uint32_t pixel = first; pixel < last; ++pixel) EXPECT_TRUE(visited.insert(pixel).second);
    });
  }
  return visited;
}

TEST(Runs, UncoveredPixelsAreThoseWithoutACounterpart) {
  for (const unsigned gaps_per_256 : {0u, 20u, 128u, 250u}) {
    const RandomRuns all(gaps_per_256);
    for (const int shift : {static_cast<int>(kWidth), -static_cast<int>(kWidth)}) {
      std::set<std::uint32_t> expected;
      for (const std::uint32_t pixel : all.pixels) {
        const int counterpart = static_cast<int>(pixel) - shift;
        if (counterpart < 0 || all.pixels.count(static_cast<std::uint32_t>(counterpart)) == 0) expected.insert(pixel);
      }
      EXPECT_EQ(uncovered(all.runs, shift), expected) << gaps_per_256 << " " << shift;
    }
  }
}

TEST(Runs, ListTheirPixels) {
  RandomRuns all(60);
  std::vector<std::uint32_t> pixels(all.pixels.size());
  EXPECT_EQ(listPixels({all.runs.data(), all.runs.size()}, pixels.data()), pixels.data() + pixels.size());
  EXPECT_EQ(pixels, std::vector<std::uint32_t>(all.pixels.begin(), all.pixels.end()));
}

}  // namespace
}  // namespace voxid
