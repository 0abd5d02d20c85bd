// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/core/code.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "../../src/core/code_distance.h"
#include "core/random.h"

namespace voxid {
namespace {

using Code = std::vector<std::uint8_t>;
using Numbers = std::vector<double>;

Code randomCode(test::Random& random) {
  std::vector<std::int64_t> numbers;
  for (std::size_t i = 0; i < kCodeNumbers; ++i) numbers.push_back(random.between(-1000, 1000));
  Code code(kCodeNumbers);
  bringToLength(numbers.data(), kCodeNumbers, code.data());
  return code;
}

Code packed(const Code& code) {
  Code small(kPackedCodeBytes);
  packCode(code.data(), small.data());
  return small;
}

Code unpacked(const Code& small) {
  Code code(kCodeNumbers);
  unpackCode(small.data(), code.data());
  return code;
}

/// Entry (i, j) of a Walsh-Hadamard matrix is the parity of the bits that i and j share.
Numbers mixed(const Code& code) {
  Numbers numbers(kCodeNumbers);
  for (std::size_t i = 0; i < kCodeNumbers; ++i) {
    for (std::size_t j = 0; j < kCodeNumbers; ++j) {
      const int sign = __builtin_popcountll(i & j) % 2 == 0 ? 1 : -1;
      numbers[i] += sign * static_cast<std::int8_t>(code[j]) / 8.0;
    }
  }
  return numbers;
}

double squaredDistanceOf(const Code& a, const Code& b) {
  const CodeNumbers x = numbersOf(a.data(), a.size()), y = numbersOf(b.data(), b.size());
  double sum = 0;
  for (std::size_t i = 0; i < kCodeNumbers; ++i) sum += (x[i] - y[i]) * (x[i] - y[i]);
  return sum;
}

TEST(Code, IsPackedAsMixedNumbersInSixteenths) {
  test::Random random(1);
  for (int i = 0; i < 20; ++i) {
    const Code code = randomCode(random), small = packed(code);
    const Numbers exact = mixed(code);
    const CodeNumbers numbers = numbersOf(small.data(), kPackedCodeBytes);
    for (std::size_t k = 0; k < kCodeNumbers; ++k)
      ASSERT_EQ(numbers[k], std::clamp(16 * std::round(exact[k] / 16), -112.0, 112.0)) << k;
  }
}

TEST(Code, APackedByteHoldsNumbersIAndIPlus32) {
  Code small(kPackedCodeBytes, 0x88);
  small[0] = 0x19, small[31] = 0xf7;
  const CodeNumbers numbers = numbersOf(small.data(), kPackedCodeBytes);
  EXPECT_EQ(numbers[0], 16);
  EXPECT_EQ(numbers[32], -112);
  EXPECT_EQ(numbers[31], -16);
  EXPECT_EQ(numbers[63], 112);
  EXPECT_EQ(std::count(numbers.begin(), numbers.end(), 0), 60);
}

TEST(Code, OppositeCodesPackToOppositeNumbers) {
  test::Random random(2);
  Code code = randomCode(random);
  const CodeNumbers numbers = numbersOf(packed(code).data(), kPackedCodeBytes);
  for (std::uint8_t& byte : code) byte = static_cast<std::uint8_t>(-static_cast<std::int8_t>(byte));
  const CodeNumbers opposite = numbersOf(packed(code).data(), kPackedCodeBytes);
  for (std::size_t i = 0; i < kCodeNumbers; ++i) EXPECT_EQ(opposite[i], -numbers[i]);
}

TEST(Code, PackingKeepsDistances) {
  test::Random random(3);
  for (int i = 0; i < 100; ++i) {
    const Code a = randomCode(random), b = randomCode(random);
    EXPECT_NEAR(std::sqrt(squaredDistanceOf(packed(a), packed(b)) / squaredDistanceOf(a, b)), 1, 0.1);
  }
}

TEST(Code, UnpackingGivesTheNumbersBackAndPacksToTheSameBytes) {
  test::Random random(4);
  double squares = 0;
  for (int i = 0; i < 100; ++i) {
    const Code code = randomCode(random), small = packed(code), again = unpacked(small);
    squares += squaredDistanceOf(code, again) / (100 * kCodeNumbers);
    EXPECT_EQ(packed(again), small);
  }
  EXPECT_NEAR(squares, 16 * 16 / 12.0, 8) << "what rounding to 16 costs, and a little that is cut off";
}

TEST(Code, DistancesAreThoseOfTheNumbersInEitherSize) {
  test::Random random(5);
  std::vector<Code> plain, small;
  Code plain_rows, small_rows;
  std::vector<std::uint32_t> order;
  for (std::uint32_t i = 0; i < 40; ++i) {
    plain.push_back(randomCode(random));
    small.push_back(packed(plain.back()));
    plain_rows.insert(plain_rows.end(), plain.back().begin(), plain.back().end());
    small_rows.insert(small_rows.end(), small.back().begin(), small.back().end());
    order.push_back((17 * i + 3) % 40);
  }
  for (const auto& [codes, rows] : {std::pair(plain, plain_rows), std::pair(small, small_rows)}) {
    const std::size_t bytes = codes[0].size();
    std::vector<std::uint32_t> all(40), some(40);
    squaredDistances(codes[0].data(), rows.data(), 40, bytes, all.data());
    squaredDistancesAt(codes[0].data(), rows.data(), order.data(), 40, bytes, some.data());
    for (std::size_t i = 0; i < 40; ++i) {
      ASSERT_EQ(all[i], squaredDistanceOf(codes[0], codes[i]));
      ASSERT_EQ(some[i], all[order[i]]);
      ASSERT_EQ(squaredDistance(codes[0].data(), codes[i].data(), bytes), all[i]);
    }
  }
}

TEST(Code, BytesThatNoPackingGivesAreHarmless) {
  const Code least(kPackedCodeBytes, 0x00), most(kPackedCodeBytes, 0xff);
  EXPECT_EQ(squaredDistance(least.data(), most.data(), kPackedCodeBytes), 64u * 240 * 240);
  EXPECT_LE(64u * 240 * 240, kMostCodeDistance);
  const Code code = unpacked(least);
  EXPECT_EQ(static_cast<std::int8_t>(code[0]), -127) << "64 x -128 / 8, clamped";
  EXPECT_EQ(std::count(code.begin(), code.end(), 0), 63);
}

}  // namespace
}  // namespace voxid
