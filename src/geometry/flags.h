// SPDX-License-Identifier: BSD-3-Clause
// Rows of bytes that are flags or small states, eight looked at together.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

namespace voxid {

constexpr std::size_t kFlagsAtOnce = sizeof(std::uint64_t);
constexpr std::uint64_t kEachByte = 0x0101010101010101;

/// The first byte in the lowest bits: every platform is little-endian.
inline std::uint64_t eightAt(const std::uint8_t* first) {
  std::uint64_t eight;
  std::memcpy(&eight, first, sizeof eight);
  return eight;
}

/// Whether all eight bytes have these bits.
inline bool allHave(std::uint8_t bits, std::uint64_t eight) { return (~eight & bits * kEachByte) == 0; }

/// Which of eight bytes is the first that is not 0; one must be.
inline std::size_t firstSet(std::uint64_t eight) { return static_cast<std::size_t>(__builtin_ctzll(eight)) / 8; }

/// visit(i) for ascending i in [first, end) whose flag, 0 or 1, is set. Reads up to seven bytes beyond the end.
template <typename Visit>
void visitSet(const std::uint8_t* flags, std::size_t first, std::size_t end, Visit visit) {
  for (std::size_t i = first; i < end; i += kFlagsAtOnce) {
    for (std::uint64_t eight = eightAt(flags + i); eight != 0; eight &= eight - 1) {
      const std::size_t at = i + firstSet(eight);
      if (at >= end) return;
      visit(at);
    }
  }
}

/// A state: hangs together with the one before.
constexpr std::uint8_t kLinked = 2;

/// The first index from i on at which there is another byte; there must be one.
inline std::size_t endOf(std::uint8_t byte, const std::uint8_t* bytes, std::size_t i) {
  const std::uint64_t eight = byte * kEachByte;
  for (;; i += kFlagsAtOnce) {
    const std::uint64_t other = eightAt(bytes + i) ^ eight;
    if (other != 0) return i + firstSet(other);
  }
}

/// visit(begin, end) for the runs in [first, last): each begins with a state that is not 0 and takes in those after it
/// that are kLinked. Behind the last there must be eight zeros.
template <typename Visit>
void visitLinked(const std::uint8_t* states, std::size_t first, std::size_t last, Visit visit) {
  for (std::size_t i = first; i < last;) {
    const std::uint64_t eight = eightAt(states + i);
    if (eight == 0) {
      i += kFlagsAtOnce;
      continue;
    }
    const std::size_t begin = i + firstSet(eight);
    i = endOf(kLinked, states, begin + 1);
    visit(begin, i);
  }
}

}  // namespace voxid
