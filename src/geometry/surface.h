// SPDX-License-Identifier: BSD-3-Clause
// The depth image of a frame with its table, as the steps after the table see it.
#pragma once

#include <cstdint>

#include "inverse_depth.h"
#include "plan.h"
#include "plane.h"
#include "runs.h"

namespace voxid {

struct Surface {
  const InverseDepth& inverse;
  const PlaneSums& table;
  const Rays& rays;
  const Plan& plan;
  const PlanRays& plan_rays;
  double distance_m;  ///< camera above the table

  int row(std::uint32_t pixel) const { return static_cast<int>(pixel / static_cast<std::uint32_t>(inverse.width_px)); }

  /// The pixel must have depth.
  PointUm point(std::uint32_t pixel) const {
    const int v = row(pixel);
    return pointAt(static_cast<int>(pixel) - v * inverse.width_px, v, pixel);
  }
  PointUm pointAt(int u, int v, std::uint32_t pixel) const {
    return rays.point(u, v, depthUmOf(inverse.values[pixel]));
  }

  /// Appends a run's points in the plan.
  void place(Run run, PlacedPoints& placed) const {
    const int v = row(run.begin), u = static_cast<int>(run.begin) - v * inverse.width_px;
    plan_rays.place(inverse.row(v) + u, u, v, static_cast<int>(run.end - run.begin), placed);
  }

  /// Their heights above the table, micrometres.
  void heights(Run run, std::int32_t* heights_um) const {
    const int v = row(run.begin), u = static_cast<int>(run.begin) - v * inverse.width_px;
    plan_rays.heights(inverse.row(v) + u, u, v, static_cast<int>(run.end - run.begin), heights_um);
  }
};

}  // namespace voxid
