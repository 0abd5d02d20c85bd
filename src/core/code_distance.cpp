// SPDX-License-Identifier: BSD-3-Clause
#include "code_distance.h"

#include "vectorised.h"
#include "voxid/core/projection.h"

namespace voxid {
namespace {

// Differences as 16-bit numbers: compilers then find the instruction that squares and adds pairs (pmaddwd).
template <std::size_t kBytes>
inline __attribute__((always_inline)) std::uint32_t squared(const std::int8_t* a, const std::int8_t* b) {
  std::int32_t sum = 0;
  for (std::size_t i = 0; i < kBytes; ++i) {
    const auto d = static_cast<std::int16_t>(a[i] - b[i]);
    sum += d * d;
  }
  return static_cast<std::uint32_t>(sum);
}

template <std::size_t kBytes>
inline __attribute__((always_inline)) void all(const std::int8_t* query, const std::int8_t* codes, std::size_t count,
                                               std::uint32_t* distances) {
  for (std::size_t i = 0; i < count; ++i) distances[i] = squared<kBytes>(query, codes + i * kBytes);
}

// A list's codes lie anywhere: asked for some rows ahead, they come while others are compared.
template <std::size_t kBytes>
inline __attribute__((always_inline)) void some(const std::int8_t* query, const std::int8_t* codes,
                                                const std::uint32_t* rows, std::size_t count,
                                                std::uint32_t* distances) {
  constexpr std::size_t kAhead = 12;
  for (std::size_t i = 0; i < count; ++i) {
    if (i + kAhead < count) __builtin_prefetch(codes + std::size_t{rows[i + kAhead]} * kBytes);
    distances[i] = squared<kBytes>(query, codes + std::size_t{rows[i]} * kBytes);
  }
}

const std::int8_t* signedBytes(const std::uint8_t* code) { return reinterpret_cast<const std::int8_t*>(code); }

VOXID_VECTORISED void all64(const std::int8_t* q, const std::int8_t* c, std::size_t n, std::uint32_t* out) {
  all<64>(q, c, n, out);
}
VOXID_VECTORISED void all32(const std::int8_t* q, const std::int8_t* c, std::size_t n, std::uint32_t* out) {
  all<32>(q, c, n, out);
}
VOXID_VECTORISED void some64(const std::int8_t* q, const std::int8_t* c, const std::uint32_t* rows, std::size_t n,
                             std::uint32_t* out) {
  some<64>(q, c, rows, n, out);
}
VOXID_VECTORISED void some32(const std::int8_t* q, const std::int8_t* c, const std::uint32_t* rows, std::size_t n,
                             std::uint32_t* out) {
  some<32>(q, c, rows, n, out);
}

}  // namespace

std::uint32_t squaredDistance(const std::uint8_t* a, const std::uint8_t* b, std::size_t code_bytes) {
  std::uint32_t distance = 0;
  squaredDistances(a, b, 1, code_bytes, &distance);
  return distance;
}

void squaredDistances(const std::uint8_t* query, const std::uint8_t* codes, std::size_t count, std::size_t code_bytes,
                      std::uint32_t* distances) {
  (code_bytes == 64 ? all64 : all32)(signedBytes(query), signedBytes(codes), count, distances);
}

void squaredDistancesAt(const std::uint8_t* query, const std::uint8_t* codes, const std::uint32_t* rows,
                        std::size_t count, std::size_t code_bytes, std::uint32_t* distances) {
  (code_bytes == 64 ? some64 : some32)(signedBytes(query), signedBytes(codes), rows, count, distances);
}

}  // namespace voxid
