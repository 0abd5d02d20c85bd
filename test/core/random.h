// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace voxid::test {

/// Numbers for tests: the same on every machine (std::uniform_int_distribution is not).
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed * 2 + 1) {}

  std::uint32_t bits() {
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    return static_cast<std::uint32_t>(state_ >> 32);
  }
  /// 0 to limit - 1.
  int below(int limit) { return static_cast<int>(std::uint64_t{bits()} * static_cast<std::uint32_t>(limit) >> 32); }
  /// least to most.
  int between(int least, int most) { return least + below(most - least + 1); }

 private:
  std::uint64_t state_;
};

}  // namespace voxid::test
