// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <string_view>

namespace voxid {

/// SplitMix64 (Steele, Lea, Flood 2014): one stream a seed, the same everywhere. Only +, *, / and square roots go into
/// what is derived from it, no library function that rounds differently elsewhere.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  std::uint64_t next() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }

  float unit() { return static_cast<float>(next() >> 40) * (1.0f / (1 << 24)); }  ///< [0, 1)
  float between(float low, float high) { return low + (high - low) * unit(); }
  int below(int n) { return static_cast<int>((next() >> 32) * static_cast<std::uint64_t>(n) >> 32); }  ///< [0, n)
  bool chance(float share) { return unit() < share; }

  /// Nearly normal: mean 0, deviation 1, never beyond 3.5; the sum of four 16-bit uniforms.
  float normal() {
    const std::uint64_t bits = next();
    int sum = 0;
    for (int i = 0; i < 4; ++i) sum += static_cast<int>((bits >> (16 * i)) & 0xffff);
    constexpr float kDeviation = 37837.23f;  // sqrt(4 (2^32 - 1) / 12)
    return (static_cast<float>(sum) - 131070.0f) / kDeviation;
  }

 private:
  std::uint64_t state_;
};

/// A seed from a name (FNV-1a) and a number.
inline std::uint64_t seedOf(std::string_view name, std::uint64_t number = 0) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const char c : name) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
  return Random(hash ^ (number * 0x9e3779b97f4a7c15u)).next();
}

}  // namespace voxid
