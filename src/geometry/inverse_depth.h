// SPDX-License-Identifier: BSD-3-Clause
// Inverse depth: a plane in space is affine in the pixel, and the noise of a structured-light sensor nearly constant.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "voxid/core/depth_view.h"

namespace voxid {

/// Inverse depths are integers in 1/256 of 1/km: 1 m is 256,000, and one unit there 4 um.
constexpr std::int32_t kUnitsPerKm = 256;
constexpr double kUnitsTimesUm = 1e9 * kUnitsPerKm;  ///< inverse depth times depth_um

struct InverseDepth {
  int width_px = 0, height_px = 0;
  std::vector<std::int32_t> values;  ///< row by row; 0 = no depth, or outside the range asked for
  std::uint32_t valid = 0;           ///< values that are not 0

  const std::int32_t* row(int v) const { return values.data() + static_cast<std::size_t>(v) * width_px; }
};

/// Reads the whole image. Allocates only if it is larger than any before.
void invert(const DepthView& depth, int min_depth_mm, int max_depth_mm, InverseDepth& inverse);

/// Micrometres; `inverse` must not be 0.
inline std::int32_t depthUmOf(std::int32_t inverse) { return static_cast<std::int32_t>(kUnitsTimesUm / inverse + 0.5); }

/// Whether two inverse depths belong to depths that differ by less than a step: |1/a - 1/b| < step, multiplied out.
class DepthStep {
 public:
  explicit DepthStep(int step_mm = 0) : step_(static_cast<float>(step_mm * 1000 / kUnitsTimesUm)) {}
  /// False if one of them is 0.
  bool within(std::int32_t a, std::int32_t b) const {
    const auto from = static_cast<float>(a), to = static_cast<float>(b);
    return std::abs(from - to) < step_ * from * to;
  }

 private:
  float step_;
};

}  // namespace voxid
