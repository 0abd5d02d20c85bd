// SPDX-License-Identifier: BSD-3-Clause
// The depth image of a frame with its table, as the steps after the table see it.
#pragma once

#include <algorithm>
#include <cstdint>

#include "inverse_depth.h"
#include "plan.h"
#include "plane.h"
#include "voxid/core/span.h"

namespace voxid {

/// Pixels side by side in a row: the indices (row * width + column) from begin up to, not including, end.
struct Run {
  std::uint32_t begin, end;
};

/// visit(run) for the runs of ascending pixels, in images of that width.
template <typename Visit>
void visitRuns(Span<const std::uint32_t> pixels, std::uint32_t width, Visit visit) {
  // Runs are long: as pixels ascend, one far pixel in its place tells of all before.
  constexpr std::size_t kStride = 16;
  for (std::size_t i = 0; i < pixels.size;) {
    const std::uint32_t begin = pixels[i];
    const std::size_t most = std::min<std::size_t>(pixels.size - i, width - begin % width);
    const auto continues = [&](std::size_t k) { return k < most && pixels[i + k] == begin + k; };
    std::size_t last = 0;
    while (continues(last + kStride)) last += kStride;
    for (std::size_t step = kStride / 2; step > 0; step /= 2) last += continues(last + step) ? step : 0;
    visit(Run{begin, pixels[i + last] + 1});
    i += last + 1;
  }
}

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
