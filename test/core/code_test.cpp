// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/core/code.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "../../src/core/code_distance.h"
#include "core/random.h"

namespace voxid {
namespace {

using Code = std::vector<std::uint8_t>;
using Numbers = std::vector<double>;
using Whole = std::vector<std::int64_t>;

/// Of a projection, those of lower number larger.
Whole randomNumbers(test::Random& random) {
  Whole numbers;
  for (int i = 0; i < static_cast<int>(kCodeNumbers); ++i) {
    const int most = 100000 / (10 + i);
    numbers.push_back(random.between(-most, most));
  }
  return numbers;
}

Code packed(const Whole& numbers, std::size_t bytes) {
  Code code(bytes);
  packCode(numbers.data(), bytes, code.data());
  return code;
}

/// kCodeLength of the first `count` over their length, cut.
Numbers cutToLength(const Whole& numbers, std::size_t count) {
  Numbers scaled(numbers.begin(), numbers.begin() + static_cast<std::ptrdiff_t>(count));
  const double length = std::sqrt(std::inner_product(scaled.begin(), scaled.end(), scaled.begin(), 0.0));
  for (double& number : scaled) number = std::clamp(number * kCodeLength / length, -90.0, 90.0);
  return scaled;
}

/// Entry (i, j) of a Walsh-Hadamard matrix is the parity of the bits that i and j share; every n/16-th number is mixed.
Numbers mixed(const Numbers& numbers) {
  const std::size_t stride = numbers.size() / 16;
  Numbers out(numbers.size());
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    for (std::size_t j = i % stride; j < numbers.size(); j += stride) {
      const int sign = __builtin_popcountll((i / stride) & (j / stride)) % 2 == 0 ? 1 : -1;
      out[i] += sign * numbers[j] / 4.0;
    }
  }
  return out;
}

double squaredDistanceOf(const CodeNumbers& x, const CodeNumbers& y) {
  double sum = 0;
  for (std::size_t i = 0; i < kCodeNumbers; ++i) sum += (x[i] - y[i]) * (x[i] - y[i]);
  return sum;
}

double squaredDistanceOf(const Code& a, const Code& b) {
  return squaredDistanceOf(numbersOf(a.data(), a.size()), numbersOf(b.data(), b.size()));
}

class CodeOf : public testing::TestWithParam<std::size_t> {
 protected:
  const std::size_t kBytes = GetParam(), kCount = numbersIn(GetParam());
};

TEST_P(CodeOf, AProjectionsNumbersAreCutMixedAndRoundedToSixteens) {
  test::Random random(1);
  for (int i = 0; i < 20; ++i) {
    const Whole numbers = randomNumbers(random);
    const Numbers exact = mixed(cutToLength(numbers, kCount));
    const CodeNumbers held = numbersOf(packed(numbers, kBytes).data(), kBytes);
    for (std::size_t k = 0; k < kCount; ++k) {
      ASSERT_NEAR(held[k], std::clamp(exact[k], -112.0, 112.0), 8.3) << k;
      ASSERT_EQ(held[k] % 16, 0) << k;
    }
    EXPECT_EQ(std::count(held.begin() + static_cast<std::ptrdiff_t>(kCount), held.end(), 0), kCodeNumbers - kCount);
  }
}

TEST_P(CodeOf, AByteHoldsTwoNumbersHalfACodeApart) {
  Code code(kBytes, 0x88);
  code.front() = 0x19, code.back() = 0xf7;
  const CodeNumbers numbers = numbersOf(code.data(), kBytes);
  EXPECT_EQ(numbers[0], 16);
  EXPECT_EQ(numbers[kBytes], -112);
  EXPECT_EQ(numbers[kBytes - 1], -16);
  EXPECT_EQ(numbers[kCount - 1], 112);
  EXPECT_EQ(std::count(numbers.begin(), numbers.end(), 0), kCodeNumbers - 4);
}

TEST_P(CodeOf, OppositeNumbersAreOpposite) {
  test::Random random(2);
  Whole numbers = randomNumbers(random);
  const CodeNumbers held = numbersOf(packed(numbers, kBytes).data(), kBytes);
  for (std::int64_t& number : numbers) number = -number;
  const CodeNumbers opposite = numbersOf(packed(numbers, kBytes).data(), kBytes);
  for (std::size_t i = 0; i < kCodeNumbers; ++i) EXPECT_EQ(opposite[i], -held[i]);
}

TEST_P(CodeOf, DistancesAreKept) {
  test::Random random(3);
  for (int i = 0; i < 100; ++i) {
    const Whole a = randomNumbers(random), b = randomNumbers(random);
    const Numbers x = cutToLength(a, kCount), y = cutToLength(b, kCount);
    double squares = 0;
    for (std::size_t k = 0; k < kCount; ++k) squares += (x[k] - y[k]) * (x[k] - y[k]);
    EXPECT_NEAR(std::sqrt(squaredDistanceOf(packed(a, kBytes), packed(b, kBytes)) / squares), 1, 0.1);
  }
}

TEST_P(CodeOf, UnpackingGivesTheNumbersBack) {
  test::Random random(4);
  double squares = 0;
  for (int i = 0; i < 100; ++i) {
    const Whole numbers = randomNumbers(random);
    const Numbers exact = cutToLength(numbers, kCount);
    const CodeNumbers again = unpackCode(packed(numbers, kBytes).data(), kBytes);
    for (std::size_t k = 0; k < kCount; ++k)
      squares += (again[k] - exact[k]) * (again[k] - exact[k]) / (100.0 * static_cast<double>(kCount));
    EXPECT_TRUE(std::all_of(again.begin() + static_cast<std::ptrdiff_t>(kCount), again.end(),
                            [](std::int8_t number) { return number == 0; }));
  }
  EXPECT_NEAR(squares, 16 * 16 / 12.0, 8) << "what rounding to 16 costs, and a little that is cut off";
}

TEST_P(CodeOf, MixedNumbersAreBroughtToLength) {
  test::Random random(6);
  Whole numbers;
  for (std::size_t i = 0; i < kCodeNumbers; ++i) numbers.push_back(random.between(-1000, 1000));
  Code code(kBytes);
  bringToLength(numbers.data(), kBytes, code.data());
  double squares = 0;
  for (std::size_t i = 0; i < kCount; ++i) squares += static_cast<double>(numbers[i] * numbers[i]);
  const CodeNumbers held = numbersOf(code.data(), kBytes);
  for (std::size_t i = 0; i < kCount; ++i) {
    const double exact = static_cast<double>(numbers[i]) * kCodeLength / std::sqrt(squares);
    EXPECT_NEAR(held[i], std::clamp(exact, -112.0, 112.0), 8.1) << i;
  }
}

TEST_P(CodeOf, NothingStaysNothing) {
  const Whole none(kCodeNumbers, 0);
  Code code(kBytes);
  bringToLength(none.data(), kBytes, code.data());
  for (const Code& zero : {packed(none, kBytes), code}) EXPECT_EQ(zero, Code(kBytes, 0x88));
}

TEST_P(CodeOf, DistancesAreThoseOfTheNumbers) {
  constexpr std::uint32_t kRows = 43;  // not a multiple of what is compared at once
  test::Random random(5);
  std::vector<Code> codes;
  Code rows;
  std::vector<std::uint32_t> order;
  for (std::uint32_t i = 0; i < kRows; ++i) {
    codes.push_back(packed(randomNumbers(random), kBytes));
    rows.insert(rows.end(), codes.back().begin(), codes.back().end());
    order.push_back((17 * i + 3) % kRows);
  }
  std::vector<std::uint32_t> all(kRows), some(kRows);
  squaredDistances(codes[0].data(), rows.data(), kRows, kBytes, all.data());
  squaredDistancesAt(codes[0].data(), rows.data(), order.data(), kRows, kBytes, some.data());
  for (std::size_t i = 0; i < kRows; ++i) {
    ASSERT_EQ(all[i], squaredDistanceOf(codes[0], codes[i]));
    ASSERT_EQ(some[i], all[order[i]]);
    ASSERT_EQ(squaredDistance(codes[0].data(), codes[i].data(), kBytes), all[i]);
  }
}

TEST_P(CodeOf, BytesThatNoPackingGivesAreHarmless) {
  const Code least(kBytes, 0x00), most(kBytes, 0xff);
  EXPECT_EQ(squaredDistance(least.data(), most.data(), kBytes), kCount * 240 * 240);
  EXPECT_EQ(squaredDistance(most.data(), least.data(), kBytes), kCount * 240 * 240);
  EXPECT_EQ(squaredDistance(most.data(), most.data(), kBytes), 0u);
  EXPECT_LE(kCount * 240 * 240, kMostCodeDistance);
  const CodeNumbers numbers = unpackCode(least.data(), kBytes);
  EXPECT_EQ(numbers[0], -127) << "16 x -128 / 4, clamped";
  EXPECT_EQ(std::count(numbers.begin(), numbers.end(), 0), kCodeNumbers - kCount / 16);
}

INSTANTIATE_TEST_SUITE_P(, CodeOf, testing::Values(kSmallCodeBytes, kCodeBytes), testing::PrintToStringParamName());

TEST(CodeNumbers, DistancesToRowsAreThoseOfTheNumbers) {
  test::Random random(7);
  CodeNumbers query;
  for (std::int8_t& number : query) number = static_cast<std::int8_t>(random.between(-127, 127));
  std::vector<CodeNumbers> rows(9);
  for (CodeNumbers& row : rows) {
    for (std::int8_t& number : row) number = static_cast<std::int8_t>(random.between(-128, 127));
  }
  std::vector<std::uint32_t> distances(rows.size());
  squaredDistances(query, rows[0].data(), rows.size(), distances.data());
  for (std::size_t i = 0; i < rows.size(); ++i) EXPECT_EQ(distances[i], squaredDistanceOf(query, rows[i]));
}

}  // namespace
}  // namespace voxid
