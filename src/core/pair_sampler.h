// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace voxid {

/// Draws pairs of different points: SplitMix64, one 64-bit number a pair, its halves mapped to a range by
/// multiplication (at most one part in 65,536 from uniform, and no division). The state is the whole of the randomness
/// in a descriptor.
class PairSampler {
 public:
  struct Pair {
    std::uint32_t first, second;  ///< different, both below the number of points
  };

  /// `points` is 2 to 65,536.
  PairSampler(std::uint32_t seed, std::uint32_t points) : state_(seed), points_(points) {}

  Pair next() {
    const std::uint64_t number = nextNumber();
    const std::uint32_t first = below(points_, static_cast<std::uint32_t>(number >> 32));
    const std::uint32_t other = below(points_ - 1, static_cast<std::uint32_t>(number));
    return {first, other + (other >= first)};  // skips `first`: different by construction
  }

 private:
  static std::uint32_t below(std::uint32_t limit, std::uint32_t number) {
    return static_cast<std::uint32_t>(std::uint64_t{number} * limit >> 32);
  }
  std::uint64_t nextNumber() {
    std::uint64_t z = state_ += 0x9e3779b97f4a7c15;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9;
    z = (z ^ z >> 27) * 0x94d049bb133111eb;
    return z ^ z >> 31;
  }

  std::uint64_t state_;
  std::uint32_t points_;
};

}  // namespace voxid
