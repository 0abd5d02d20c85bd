// SPDX-License-Identifier: BSD-3-Clause
// The parts of backProject() that do not divide.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

namespace voxid {

constexpr int kMaxPixel = 32767;

/// |pixel| <= 32,767 and |z| <= 2^31 keep it below (2^32 - 2^16) 2^31 < 2^63 - 2^46.
inline std::int64_t lateralProduct(std::int64_t pixel, std::int32_t centre_q16, std::int32_t z_um) {
  const std::int64_t within = std::min<std::int64_t>(std::max<std::int64_t>(pixel, -kMaxPixel), kMaxPixel);
  return (within * 65536 - centre_q16) * z_um;
}

inline std::int32_t saturatedUm(std::int64_t um) {
  using Limits = std::numeric_limits<std::int32_t>;
  return static_cast<std::int32_t>(std::min<std::int64_t>(std::max<std::int64_t>(um, Limits::min()), Limits::max()));
}

}  // namespace voxid
