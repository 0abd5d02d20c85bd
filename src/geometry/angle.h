// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

namespace voxid {

/// Rounded, so that the last bit of a platform's cosine decides nothing.
inline double cosineOf(int angle_deg) {
  constexpr double kDegree = 3.14159265358979323846 / 180;
  return std::round(std::cos(angle_deg * kDegree) * 1e6) / 1e6;
}

}  // namespace voxid
