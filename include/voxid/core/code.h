// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace voxid {

/// A code of profile "default" is 64 numbers, -127 to 127, of length kCodeLength, compared by their squared distance.
/// It takes 64 bytes, a signed byte a number, or is packed into 32, four bits a number, which names as much within a
/// point (doc/benchmarks.md). What belongs to an index has the size of its codes, queries too.
constexpr std::size_t kCodeNumbers = 64, kPackedCodeBytes = 32;
constexpr int kCodeLength = 360;
using CodeNumbers = std::array<std::int8_t, kCodeNumbers>;

/// From 64 bytes to 32: the numbers are mixed by a Walsh-Hadamard matrix, which keeps distances and makes all of them
/// vary as much, so that four bits do for each, and rounded to the nearest multiple of 16, halves away from zero, from
/// -112 to 112. A packed byte holds number i in its lower half and number i + 32 in its upper one, in sixteenths, 8
/// more than they are.
void packCode(const std::uint8_t* code, std::uint8_t* packed);
/// The way back, as far as rounding lets it.
void unpackCode(const std::uint8_t* packed, std::uint8_t* code);

/// A code's numbers as distances count them: of a packed one the mixed numbers, -128 only in a damaged file.
CodeNumbers numbersOf(const std::uint8_t* code, std::size_t code_bytes);

/// Writes 64 numbers below 2^24 in size as a code, kCodeLength of them over their own length: as bytes rounded towards
/// zero and clamped to -127 to 127; packed (the numbers are mixed already) as packCode rounds. All zero stay zero.
void bringToLength(const std::int64_t* numbers, std::size_t code_bytes, std::uint8_t* code);

/// Squared Euclidean distance of two codes, at most kMostCodeDistance.
std::uint32_t squaredDistance(const std::uint8_t* a, const std::uint8_t* b, std::size_t code_bytes);
constexpr std::uint32_t kMostCodeDistance = kCodeNumbers * 254 * 254;

}  // namespace voxid
