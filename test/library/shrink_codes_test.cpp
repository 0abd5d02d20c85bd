// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/library/shrink_codes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "../../src/library/random.h"
#include "voxid/core/code.h"

namespace voxid {
namespace {

using Code = std::vector<std::uint8_t>;

std::vector<Code> randomCodes(std::size_t count, std::size_t bytes) {
  Random random(4);
  std::vector<Code> codes(count, Code(bytes));
  for (Code& code : codes) {
    std::vector<std::int64_t> numbers;
    for (std::size_t i = 0; i < kCodeNumbers; ++i) numbers.push_back(random.below(2001) - 700);
    bringToLength(numbers.data(), bytes, code.data());
  }
  return codes;
}

std::vector<std::uint8_t*> pointersTo(std::vector<Code>& codes) {
  std::vector<std::uint8_t*> pointers;
  for (Code& code : codes) pointers.push_back(code.data());
  return pointers;
}

double number(const Code& code, std::size_t i) { return numbersOf(code.data(), code.size())[i]; }

std::vector<double> slowlyShrunk(const std::vector<Code>& codes, std::size_t which) {
  std::vector<double> moved;
  double squares = 0;
  for (std::size_t i = 0; i < kCodeNumbers; ++i) {
    double mean = 0;
    for (const Code& code : codes) mean += number(code, i) / static_cast<double>(codes.size());
    moved.push_back(0.75 * number(codes[which], i) + 0.25 * mean);
    squares += moved.back() * moved.back();
  }
  for (double& m : moved) m *= kCodeLength / std::sqrt(squares);
  return moved;
}

TEST(ShrinkToMean, MovesEveryCodeAQuarterOfTheWay) {
  for (const std::size_t bytes : {32u, 64u}) {
    const double most = bytes == 32 ? 112 : 127, within = bytes == 32 ? 8.01 : 1.01;
    const std::vector<Code> before = randomCodes(80, bytes);
    std::vector<Code> after = before;
    shrinkToMean(pointersTo(after), bytes);
    for (std::size_t view = 0; view < before.size(); ++view) {
      const std::vector<double> expected = slowlyShrunk(before, view);
      for (std::size_t i = 0; i < kCodeNumbers; ++i)
        ASSERT_NEAR(number(after[view], i), std::clamp(expected[i], -most, most), within);
    }
  }
}

TEST(ShrinkToMean, LeavesASingleViewAndNoViewAsTheyAre) {
  const std::vector<Code> before = randomCodes(1, 64);
  std::vector<Code> after = before;
  shrinkToMean(pointersTo(after), 64);
  for (std::size_t i = 0; i < 64; ++i) EXPECT_NEAR(number(after[0], i), number(before[0], i), 1);
  shrinkToMean({}, 64);
}

TEST(ShrinkToMean, OppositeCodesCancelOutToNothingWorse) {
  std::vector<Code> codes = randomCodes(1, 64);
  Code opposite = codes[0];
  for (std::uint8_t& byte : opposite) byte = static_cast<std::uint8_t>(-static_cast<std::int8_t>(byte));
  codes.push_back(opposite);
  const Code before = codes[0];
  shrinkToMean(pointersTo(codes), 64);
  for (std::size_t i = 0; i < 64; ++i) EXPECT_NEAR(number(codes[0], i), number(before, i), 1);
}

}  // namespace
}  // namespace voxid
