// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/core/key.h"

namespace voxid {
namespace {

constexpr int kBinsPerBit = 8;

int peakOf(const std::uint8_t* bins, const SubHistogram& part) {
  int peak = part.first_bin;
  for (int i = peak + 1; i < part.first_bin + part.bins; ++i) {
    if (bins[i] > bins[peak]) peak = i;
  }
  return peak;
}

}  // namespace

Key keyOf(const std::uint8_t* bins416) {
  Key key = 0;
  for (const SubHistogram& part : kSubHistograms) {
    const int peak = peakOf(bins416, part);
    if (bins416[peak] != 0) key |= Key{1} << peak / kBinsPerBit;
  }
  return key;
}

// Counts by halves: without a popcount instruction (plain x86-64) several times faster than the compiler's call.
int hammingDistance(Key a, Key b) {
  std::uint64_t x = a ^ b;
  x -= x >> 1 & 0x5555555555555555;
  x = (x & 0x3333333333333333) + (x >> 2 & 0x3333333333333333);
  x = (x + (x >> 4)) & 0x0f0f0f0f0f0f0f0f;
  return static_cast<int>(x * 0x0101010101010101 >> 56);
}

}  // namespace voxid
