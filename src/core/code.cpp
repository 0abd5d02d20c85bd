// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/core/code.h"

#include <algorithm>

#include "code_distance.h"
#include "normaliser.h"

namespace voxid {
namespace {

using Wide = std::array<std::int64_t, kCodeNumbers>;

constexpr std::size_t kMixed = 16;  // numbers at a time
constexpr std::int64_t kMixedGrow = 4;

// Sums and differences of numbers 1, 2, 4 and 8 strides apart: kMixedGrow times as long afterwards, twice makes
// kMixedGrow^2 times the same.
void mix(Wide& numbers, std::size_t count) {
  const std::size_t stride = count / kMixed;
  for (std::size_t apart = stride; apart < count; apart *= 2) {
    for (std::size_t i = 0; i < count; ++i) {
      if ((i / apart) % 2 != 0) continue;
      const std::int64_t a = numbers[i], b = numbers[i + apart];
      numbers[i] = a + b;
      numbers[i + apart] = a - b;
    }
  }
}

// Rounded to nearest, halves away from zero.
std::int64_t rounded(std::int64_t numerator, std::int64_t denominator) {
  return (2 * numerator + (numerator < 0 ? -denominator : denominator)) / (2 * denominator);
}

std::int64_t clamped(std::int64_t value, std::int64_t most) { return std::min(std::max(value, -most), most); }

std::int64_t lengthOf(const std::int64_t* numbers, std::size_t count) {
  std::uint64_t squares = 0;  // 96 of them below 2^48
  for (std::size_t i = 0; i < count; ++i) squares += static_cast<std::uint64_t>(numbers[i] * numbers[i]);
  return static_cast<std::int64_t>(std::max<std::uint64_t>(squareRoot(squares), 1));
}

std::uint8_t kept(std::int64_t steps) { return static_cast<std::uint8_t>(clamped(steps, kMostSteps) + kStepBias); }

std::int8_t numberOf(int kept_steps) { return static_cast<std::int8_t>((kept_steps - kStepBias) * kPackedStep); }

// `unit` of each number's units are a step.
void put(const std::int64_t* numbers, std::int64_t unit, std::size_t code_bytes, std::uint8_t* code) {
  for (std::size_t i = 0; i < code_bytes; ++i) {
    const int lower = kept(rounded(numbers[i], unit)), upper = kept(rounded(numbers[code_bytes + i], unit));
    code[i] = static_cast<std::uint8_t>(lower | upper << 4);
  }
}

}  // namespace

void packCode(const std::int64_t* numbers, std::size_t code_bytes, std::uint8_t* code) {
  constexpr std::int64_t kParts = 16;  // of a unit, kept until the mixed numbers are rounded
  const std::size_t count = numbersIn(code_bytes);
  const std::int64_t length = lengthOf(numbers, count);
  Wide scaled;
  for (std::size_t i = 0; i < count; ++i)
    scaled[i] = clamped(numbers[i] * kCodeLength * kParts / length, kMostNumber * kParts);
  mix(scaled, count);
  put(scaled.data(), kParts * kMixedGrow * kPackedStep, code_bytes, code);
}

CodeNumbers unpackCode(const std::uint8_t* code, std::size_t code_bytes) {
  const CodeNumbers mixed = numbersOf(code, code_bytes);
  Wide wide;
  std::copy(mixed.begin(), mixed.end(), wide.begin());
  mix(wide, numbersIn(code_bytes));
  CodeNumbers numbers;
  for (std::size_t i = 0; i < kCodeNumbers; ++i)
    numbers[i] = static_cast<std::int8_t>(clamped(rounded(wide[i], kMixedGrow), 127));
  return numbers;
}

CodeNumbers numbersOf(const std::uint8_t* code, std::size_t code_bytes) {
  CodeNumbers numbers{};
  for (std::size_t i = 0; i < code_bytes; ++i) {
    numbers[i] = numberOf(code[i] & 15);
    numbers[code_bytes + i] = numberOf(code[i] >> 4);
  }
  return numbers;
}

void bringToLength(const std::int64_t* numbers, std::size_t code_bytes, std::uint8_t* code) {
  const std::size_t count = numbersIn(code_bytes);
  const std::int64_t length = lengthOf(numbers, count);
  Wide scaled;
  for (std::size_t i = 0; i < count; ++i) scaled[i] = numbers[i] * kCodeLength;
  put(scaled.data(), length * kPackedStep, code_bytes, code);
}

}  // namespace voxid
