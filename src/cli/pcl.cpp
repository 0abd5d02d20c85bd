// SPDX-License-Identifier: BSD-3-Clause
// What pcl/ does, by way of on_demand.h.
#include "on_demand.h"
#include "pcl/table.h"

namespace voxid::cli {
namespace {

const PclTable& table() { return tableOf<PclTable>("pcl"); }

}  // namespace

std::unique_ptr<Esf> makeEsf() { return table().esf(); }
PclPose poseByPcl(const ObservedObject& object, const ModelSurface& surface, float scale_mm, unsigned seed) {
  return table().pose(object, surface, scale_mm, seed);
}
PclClusters segmentByPcl(const DepthView& depth, int voxel_mm) { return table().segment(depth, voxel_mm); }
Result<std::vector<std::array<float, 3>>> readPcdFile(const std::string& path) { return table().read_pcd(path); }

}  // namespace voxid::cli
