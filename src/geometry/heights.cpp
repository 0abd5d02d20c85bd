// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/geometry/heights.h"

namespace voxid {

void pixelsBetween(const DepthView& depth, const Table& table, double least_mm, double most_mm,
                   std::vector<std::uint32_t>& pixels) {
  const Eigen::Vector3d normal = table.normal.cast<double>();
  pixels.clear();
  for (int v = 0; v < depth.height_px; ++v) {
    for (int u = 0; u < depth.width_px; ++u) {
      const std::int32_t z_um = depth.depthUm(u, v);
      if (z_um <= 0) continue;
      const PointUm p = backProject(depth.camera, u, v, z_um);
      const double height_mm = normal.dot(Eigen::Vector3d(p.x, p.y, p.z)) * 1e-3 + table.distance_m * 1e3;
      if (height_mm >= least_mm && height_mm < most_mm)
        pixels.push_back(static_cast<std::uint32_t>(v * depth.width_px + u));
    }
  }
}

}  // namespace voxid
