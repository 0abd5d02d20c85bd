// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/core/key.h"

#include "bits.h"

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

int hammingDistance(Key a, Key b) { return bitsSet(a ^ b); }

}  // namespace voxid
