// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/geometry/heights.h"

namespace voxid {

void divide(const DepthView& depth, const Table& table, const SegmentParams& params, TableAndAbove& parts) {
  const Eigen::Vector3d normal = table.normal.cast<double>();
  const double distance_mm = table.distance_m * 1e3;
  parts.table.clear();
  parts.above.clear();
  for (int v = 0; v < depth.height_px; ++v) {
    for (int u = 0; u < depth.width_px; ++u) {
      const std::int32_t z_um = depth.depthUm(u, v);
      if (z_um < params.min_depth_mm * 1000 || z_um > params.max_depth_mm * 1000) continue;
      const PointUm p = backProject(depth.camera, u, v, z_um);
      const double height_mm = normal.dot(Eigen::Vector3d(p.x, p.y, p.z)) * 1e-3 + distance_mm;
      // The plane's inverse depth at this pixel is (1 - height / distance) / z.
      const double margin_per_km = height_mm / distance_mm / z_um * 1e9;
      const bool above = height_mm >= params.min_height_mm && margin_per_km >= params.min_margin_per_km;
      if (height_mm < -params.min_height_mm || height_mm >= params.max_height_mm) continue;
      (above ? parts.above : parts.table).push_back(static_cast<std::uint32_t>(v * depth.width_px + u));
    }
  }
}

}  // namespace voxid
