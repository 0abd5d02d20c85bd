// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace voxid {

/// A code of profile "default" holds numbers of a projection in four bits each: 96 in 48 bytes or, at some loss
/// (doc/benchmarks.md), the first 64 in 32 bytes. Codes are compared by the squared distance of their numbers. What
/// belongs to an index has the size of its codes, queries too.
constexpr std::size_t kCodeNumbers = 96, kCodeBytes = kCodeNumbers / 2, kSmallCodeBytes = 32;
constexpr std::size_t numbersIn(std::size_t code_bytes) { return 2 * code_bytes; }

/// A code's numbers, as a vector, are so long.
constexpr int kCodeLength = 360;
/// No number of a projection is larger, so that no direction decides alone: a quarter of the length. It brings more of
/// the real objects' names among the first five (doc/descriptor.md, section 7).
constexpr int kMostNumber = kCodeLength / 4;

using CodeNumbers = std::array<std::int8_t, kCodeNumbers>;

/// Writes the first numbersIn(code_bytes) of a projection's kCodeNumbers, below 2^24 in size, as a code: kCodeLength of
/// them over their own length, cut to kMostNumber, then mixed, which keeps distances and makes all of them vary alike,
/// so that four bits do for each: every (n/16)-th of n numbers by a Walsh-Hadamard matrix of 16 x 16 over 4. Then
/// rounded as bringToLength rounds. All zero stay zero.
void packCode(const std::int64_t* numbers, std::size_t code_bytes, std::uint8_t* code);
/// The way back, as far as rounding lets it: a projection's numbers, those that the code has not zero.
CodeNumbers unpackCode(const std::uint8_t* code, std::size_t code_bytes);

/// A code's mixed numbers, as distances count them, zero behind numbersIn(code_bytes). A byte holds number i in its
/// lower half and number i + code_bytes in its upper one, in sixteenths, 8 more than they are; -128 only in a damaged
/// file.
CodeNumbers numbersOf(const std::uint8_t* code, std::size_t code_bytes);

/// Writes mixed numbers below 2^24 in size as a code, kCodeLength of them over their own length, rounded to the nearest
/// multiple of 16, halves away from zero, from -112 to 112. All zero stay zero.
void bringToLength(const std::int64_t* numbers, std::size_t code_bytes, std::uint8_t* code);

/// Squared Euclidean distance of two codes, at most kMostCodeDistance.
std::uint32_t squaredDistance(const std::uint8_t* a, const std::uint8_t* b, std::size_t code_bytes);
constexpr std::uint32_t kMostCodeDistance = kCodeNumbers * 240 * 240;

}  // namespace voxid
