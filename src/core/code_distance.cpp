// SPDX-License-Identifier: BSD-3-Clause
#include "code_distance.h"

#include "vectorised.h"
#include "voxid/core/code.h"

namespace voxid {
namespace {

// Differences as 16-bit numbers: compilers then find the instruction that squares and adds pairs (pmaddwd).
inline std::int32_t squaredDifference(std::int8_t a, std::int8_t b) {
  const auto d = static_cast<std::int16_t>(a - b);
  return d * d;
}

struct PlainCodes {
  static constexpr std::size_t kBytes = kCodeNumbers;
  static inline __attribute__((always_inline)) std::uint32_t squared(const std::int8_t* query,
                                                                     const std::uint8_t* code) {
    std::int32_t sum = 0;
    for (std::size_t i = 0; i < kCodeNumbers; ++i)
      sum += squaredDifference(query[i], static_cast<std::int8_t>(code[i]));
    return static_cast<std::uint32_t>(sum);
  }
};

struct PackedCodes {
  static constexpr std::size_t kBytes = kPackedCodeBytes;
  static inline __attribute__((always_inline)) std::uint32_t squared(const std::int8_t* query,
                                                                     const std::uint8_t* code) {
    std::int32_t sum = 0;
    for (std::size_t i = 0; i < kBytes; ++i) {
      sum += squaredDifference(query[i], lowerNumber(code[i]));
      sum += squaredDifference(query[kBytes + i], upperNumber(code[i]));
    }
    return static_cast<std::uint32_t>(sum);
  }
};

template <typename Codes>
inline __attribute__((always_inline)) void all(const std::int8_t* query, const std::uint8_t* codes, std::size_t count,
                                               std::uint32_t* distances) {
  for (std::size_t i = 0; i < count; ++i) distances[i] = Codes::squared(query, codes + i * Codes::kBytes);
}

// A list's codes lie anywhere: asked for some rows ahead, they come while others are compared.
template <typename Codes>
inline __attribute__((always_inline)) void some(const std::int8_t* query, const std::uint8_t* codes,
                                                const std::uint32_t* rows, std::size_t count,
                                                std::uint32_t* distances) {
  constexpr std::size_t kAhead = 12;
  for (std::size_t i = 0; i < count; ++i) {
    if (i + kAhead < count) __builtin_prefetch(codes + std::size_t{rows[i + kAhead]} * Codes::kBytes);
    distances[i] = Codes::squared(query, codes + std::size_t{rows[i]} * Codes::kBytes);
  }
}

const std::int8_t* signedBytes(const std::uint8_t* code) { return reinterpret_cast<const std::int8_t*>(code); }

VOXID_VECTORISED void allPlain(const std::int8_t* q, const std::uint8_t* c, std::size_t n, std::uint32_t* out) {
  all<PlainCodes>(q, c, n, out);
}
VOXID_VECTORISED void allPacked(const std::int8_t* q, const std::uint8_t* c, std::size_t n, std::uint32_t* out) {
  all<PackedCodes>(q, c, n, out);
}
VOXID_VECTORISED void somePlain(const std::int8_t* q, const std::uint8_t* c, const std::uint32_t* rows, std::size_t n,
                                std::uint32_t* out) {
  some<PlainCodes>(q, c, rows, n, out);
}
VOXID_VECTORISED void somePacked(const std::int8_t* q, const std::uint8_t* c, const std::uint32_t* rows, std::size_t n,
                                 std::uint32_t* out) {
  some<PackedCodes>(q, c, rows, n, out);
}

}  // namespace

std::uint32_t squaredDistance(const std::uint8_t* a, const std::uint8_t* b, std::size_t code_bytes) {
  std::uint32_t distance = 0;
  squaredDistances(a, b, 1, code_bytes, &distance);
  return distance;
}

void squaredDistances(const std::uint8_t* query, const std::uint8_t* codes, std::size_t count, std::size_t code_bytes,
                      std::uint32_t* distances) {
  if (code_bytes == kPackedCodeBytes)
    allPacked(numbersOf(query, code_bytes).data(), codes, count, distances);
  else
    allPlain(signedBytes(query), codes, count, distances);
}

void squaredDistancesAt(const std::uint8_t* query, const std::uint8_t* codes, const std::uint32_t* rows,
                        std::size_t count, std::size_t code_bytes, std::uint32_t* distances) {
  if (code_bytes == kPackedCodeBytes)
    somePacked(numbersOf(query, code_bytes).data(), codes, rows, count, distances);
  else
    somePlain(signedBytes(query), codes, rows, count, distances);
}

}  // namespace voxid
