// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace voxid {

/// Bits set in a word, counted by halves: without a popcount instruction (plain x86-64) several times faster than the
/// compiler's library call.
inline int bitsSet(std::uint64_t word) {
  word -= word >> 1 & 0x5555555555555555;
  word = (word & 0x3333333333333333) + (word >> 2 & 0x3333333333333333);
  word = (word + (word >> 4)) & 0x0f0f0f0f0f0f0f0f;
  return static_cast<int>(word * 0x0101010101010101 >> 56);
}

}  // namespace voxid
