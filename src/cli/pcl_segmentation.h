// SPDX-License-Identifier: BSD-3-Clause
// PCL's usual way from a depth image to clusters, which voxid's segmentation is compared with.
#pragma once

#include <cstdint>
#include <vector>

#include "voxid/core/depth_view.h"

namespace voxid::cli {

struct PclClusters {
  std::vector<std::vector<std::uint32_t>> pixels;  ///< of each cluster: row * width + column, ascending
  double us = 0;                                   ///< CPU time from the cloud to the clusters
};

/// SACSegmentation for the table, ConvexHull and ExtractPolygonalPrismData for what stands on it,
/// EuclideanClusterExtraction, with voxid's depth range and smallest cluster. `voxel_mm` 0: all points; otherwise
/// VoxelGrid first, and pixels get the cluster of their voxel. The cloud is made beforehand, the pixels are collected
/// afterwards; neither is timed.
PclClusters segmentByPcl(const DepthView& depth, int voxel_mm);

}  // namespace voxid::cli
