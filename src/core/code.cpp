// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/core/code.h"

#include <algorithm>

#include "code_distance.h"
#include "normaliser.h"

namespace voxid {
namespace {

constexpr std::size_t kHalf = kCodeNumbers / 2;

// Sums and differences of numbers 1, 2, 4, .. 32 apart: eight times as long afterwards, twice makes 64 times the same.
void mix(std::array<std::int32_t, kCodeNumbers>& numbers) {
  for (std::size_t apart = 1; apart < kCodeNumbers; apart *= 2) {
    for (std::size_t i = 0; i < kCodeNumbers; ++i) {
      if ((i & apart) != 0) continue;
      const std::int32_t a = numbers[i], b = numbers[i + apart];
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

void putSteps(const std::array<std::int64_t, kCodeNumbers>& steps, std::uint8_t* packed) {
  for (std::size_t i = 0; i < kHalf; ++i) {
    const std::int64_t lower = clamped(steps[i], kMostSteps), upper = clamped(steps[kHalf + i], kMostSteps);
    packed[i] = static_cast<std::uint8_t>((lower + kStepBias) | (upper + kStepBias) << 4);
  }
}

std::int64_t lengthOf(const std::int64_t* numbers) {
  std::uint64_t squares = 0;  // 64 of them below 2^48
  for (std::size_t i = 0; i < kCodeNumbers; ++i) squares += static_cast<std::uint64_t>(numbers[i] * numbers[i]);
  return static_cast<std::int64_t>(std::max<std::uint64_t>(squareRoot(squares), 1));
}

std::int8_t numberOf(int kept) { return static_cast<std::int8_t>((kept - kStepBias) * kPackedStep); }

}  // namespace

void packCode(const std::uint8_t* code, std::uint8_t* packed) {
  std::array<std::int32_t, kCodeNumbers> numbers;
  for (std::size_t i = 0; i < kCodeNumbers; ++i) numbers[i] = static_cast<std::int8_t>(code[i]);
  mix(numbers);
  std::array<std::int64_t, kCodeNumbers> steps;
  for (std::size_t i = 0; i < kCodeNumbers; ++i) steps[i] = rounded(numbers[i], 8 * kPackedStep);
  putSteps(steps, packed);
}

void unpackCode(const std::uint8_t* packed, std::uint8_t* code) {
  const CodeNumbers mixed = numbersOf(packed, kPackedCodeBytes);
  std::array<std::int32_t, kCodeNumbers> numbers;
  std::copy(mixed.begin(), mixed.end(), numbers.begin());
  mix(numbers);
  for (std::size_t i = 0; i < kCodeNumbers; ++i)
    code[i] = static_cast<std::uint8_t>(clamped(rounded(numbers[i], 8), 127));
}

CodeNumbers numbersOf(const std::uint8_t* code, std::size_t code_bytes) {
  CodeNumbers numbers;
  if (code_bytes == kPackedCodeBytes) {
    for (std::size_t i = 0; i < kHalf; ++i) {
      numbers[i] = numberOf(code[i] & 15);
      numbers[kHalf + i] = numberOf(code[i] >> 4);
    }
  } else {
    for (std::size_t i = 0; i < kCodeNumbers; ++i) numbers[i] = static_cast<std::int8_t>(code[i]);
  }
  return numbers;
}

void bringToLength(const std::int64_t* numbers, std::size_t code_bytes, std::uint8_t* code) {
  const std::int64_t length = lengthOf(numbers);
  std::array<std::int64_t, kCodeNumbers> scaled;
  if (code_bytes == kPackedCodeBytes) {
    for (std::size_t i = 0; i < kCodeNumbers; ++i) scaled[i] = rounded(numbers[i] * kCodeLength, length * kPackedStep);
    putSteps(scaled, code);
  } else {
    for (std::size_t i = 0; i < kCodeNumbers; ++i)
      code[i] = static_cast<std::uint8_t>(clamped(numbers[i] * kCodeLength / length, 127));
  }
}

}  // namespace voxid
