// SPDX-License-Identifier: BSD-3-Clause
#include "code_distance.h"

#include <array>
#include <cstring>

#include "vectorised.h"
#include "voxid/core/code.h"

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define VOXID_AVX2
#include "code_distance_avx2.h"
#endif

namespace voxid {
namespace {

// Halves of bytes stay where they are, four of them in a 16-bit word: no number has to be moved to be compared.
template <std::size_t kSize>
struct Codes {
  static constexpr std::size_t kBytes = kSize, kWords = kBytes / 2, kParts = 4;
  using Query = std::array<std::array<std::uint16_t, kWords>, kParts>;

  static inline std::uint16_t word(const std::uint8_t* code, std::size_t i) {
    std::uint16_t bits;
    std::memcpy(&bits, code + 2 * i, sizeof bits);
    return bits;
  }

  static Query queryOf(const std::uint8_t* code) {
    Query parts;
    for (std::size_t part = 0; part < kParts; ++part) {
      for (std::size_t i = 0; i < kWords; ++i)
        parts[part][i] = static_cast<std::uint16_t>((word(code, i) >> (4 * part)) & 15);
    }
    return parts;
  }

  // In 16 bits, without a sign: (a - b)^2 is the same for b - a, and 96 squares of sixteenths sum to less than 2^15.
  static inline __attribute__((always_inline)) std::uint32_t squared(const Query& query, const std::uint8_t* code) {
    std::uint16_t sum = 0;
    for (std::size_t i = 0; i < kWords; ++i) {
      const std::uint16_t numbers = word(code, i);
      for (std::size_t part = 0; part < kParts; ++part) {
        const auto d = static_cast<std::uint16_t>(query[part][i] - ((numbers >> (4 * part)) & 15));
        sum = static_cast<std::uint16_t>(sum + std::uint32_t{d} * d);
      }
    }
    return std::uint32_t{sum} * kPackedStep * kPackedStep;
  }
};

template <std::size_t kBytes, typename CodeAt>
void distances(const std::uint8_t* query, CodeAt code, std::size_t count, std::uint32_t* out) {
#ifdef VOXID_AVX2
  static const bool has_avx2 = __builtin_cpu_supports("avx2") != 0;
  if (has_avx2) return avx2::distances<kBytes>(query, code, count, out);
#endif
  const typename Codes<kBytes>::Query q = Codes<kBytes>::queryOf(query);
  for (std::size_t i = 0; i < count; ++i) out[i] = Codes<kBytes>::squared(q, code(i));
}

template <std::size_t kBytes>
void all(const std::uint8_t* query, const std::uint8_t* codes, std::size_t count, std::uint32_t* out) {
  distances<kBytes>(
      query, [codes](std::size_t i) { return codes + i * kBytes; }, count, out);
}

// A list's codes lie anywhere: asked for some rows ahead, they come while others are compared.
template <std::size_t kBytes>
void some(const std::uint8_t* query, const std::uint8_t* codes, const std::uint32_t* rows, std::size_t count,
          std::uint32_t* out) {
  constexpr std::size_t kAhead = 16;
  const auto code = [=](std::size_t i) {
    if (i + kAhead < count) __builtin_prefetch(codes + std::size_t{rows[i + kAhead]} * kBytes);
    return codes + std::size_t{rows[i]} * kBytes;
  };
  distances<kBytes>(query, code, count, out);
}

// Differences as 16-bit numbers: compilers then find the instruction that squares and adds pairs (pmaddwd).
VOXID_VECTORISED void allNumbers(const std::int8_t* query, const std::int8_t* rows, std::size_t count,
                                 std::uint32_t* distances) {
  for (std::size_t row = 0; row < count; ++row, rows += kCodeNumbers) {
    std::int32_t sum = 0;
    for (std::size_t i = 0; i < kCodeNumbers; ++i) {
      const auto d = static_cast<std::int16_t>(query[i] - rows[i]);
      sum += d * d;
    }
    distances[row] = static_cast<std::uint32_t>(sum);
  }
}

}  // namespace

std::uint32_t squaredDistance(const std::uint8_t* a, const std::uint8_t* b, std::size_t code_bytes) {
  std::uint32_t distance = 0;
  squaredDistances(a, b, 1, code_bytes, &distance);
  return distance;
}

void squaredDistances(const std::uint8_t* query, const std::uint8_t* codes, std::size_t count, std::size_t code_bytes,
                      std::uint32_t* distances) {
  (code_bytes == kSmallCodeBytes ? all<kSmallCodeBytes> : all<kCodeBytes>)(query, codes, count, distances);
}

void squaredDistancesAt(const std::uint8_t* query, const std::uint8_t* codes, const std::uint32_t* rows,
                        std::size_t count, std::size_t code_bytes, std::uint32_t* distances) {
  (code_bytes == kSmallCodeBytes ? some<kSmallCodeBytes> : some<kCodeBytes>)(query, codes, rows, count, distances);
}

void squaredDistances(const CodeNumbers& query, const std::int8_t* rows, std::size_t count, std::uint32_t* distances) {
  allNumbers(query.data(), rows, count, distances);
}

}  // namespace voxid
