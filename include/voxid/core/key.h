// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "voxid/core/descriptor.h"

namespace voxid {

/// The paper's 52-bit hash key (Sec. IV.B, Fig. 9): bit i stands for bins 8 i to 8 i + 7; the bit of the highest bin of
/// each sub-histogram is set, the lowest bin wins a tie, an all-zero sub-histogram sets none. At most six bits are set.
constexpr int kKeyBits = 52;
using Key = std::uint64_t;

Key keyOf(const std::uint8_t* bins416);
inline Key keyOf(const Descriptor& d) { return keyOf(d.data()); }

/// Number of differing bits.
int hammingDistance(Key a, Key b);

}  // namespace voxid
