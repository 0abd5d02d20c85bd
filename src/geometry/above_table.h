// SPDX-License-Identifier: BSD-3-Clause
// Which pixels are above the table.
#pragma once

#include <cstdint>
#include <vector>

#include "inverse_depth.h"
#include "plane.h"

namespace voxid {

/// Pixels higher than `lowest` and not above `highest` that differ from the table in inverse depth as well. A plane
/// parallel to the table is affine in the pixel too, so that a pixel needs additions and comparisons only.
class AboveTable {
 public:
  void reserve(int width_px, int height_px);
  void set(const PlaneSums& table, double distance_m, int lowest_mm, int highest_mm, int margin_per_km);

  /// Of each pixel of a row: 0 = not above, 1 = above, 2 = above and within `gap` of the pixel on its left, which is
  /// too.
  void mark(const std::int32_t* values, int v, int width_px, DepthStep gap, std::uint8_t* states) const;
  bool contains(std::int32_t value, int u, int v) const {
    const auto column = static_cast<std::size_t>(u), row = static_cast<std::size_t>(v);
    return value > 0 && value > margin_.columns[column] + margin_.rows[row] &&
           value > lowest_.columns[column] + lowest_.rows[row] &&
           sign_ * value <= highest_.columns[column] + highest_.rows[row];
  }

 private:
  PlaneSums margin_, lowest_, highest_;  ///< inverse depths that a pixel has to exceed, and not to exceed
  std::int32_t sign_ = 1;                ///< of highest_: -1 if the camera is lower than that
};

}  // namespace voxid
