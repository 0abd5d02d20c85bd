// SPDX-License-Identifier: BSD-3-Clause
// The depth image of a frame with its table, as the steps after the table see it.
#pragma once

#include <cstdint>

#include "inverse_depth.h"
#include "plan.h"
#include "plane.h"

namespace voxid {

struct Surface {
  const InverseDepth& inverse;
  const PlaneSums& table;
  const Rays& rays;
  const Plan& plan;
  double distance_m;  ///< camera above the table

  int column(std::uint32_t pixel) const {
    return static_cast<int>(pixel % static_cast<std::uint32_t>(inverse.width_px));
  }
  int row(std::uint32_t pixel) const { return static_cast<int>(pixel / static_cast<std::uint32_t>(inverse.width_px)); }

  /// The pixel must have depth.
  PointUm point(std::uint32_t pixel) const {
    return rays.point(column(pixel), row(pixel), depthUmOf(inverse.values[pixel]));
  }
};

}  // namespace voxid
