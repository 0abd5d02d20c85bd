// SPDX-License-Identifier: BSD-3-Clause
// What PCL does for the pose of a known model: measured beside ours.
#pragma once

#include <optional>

#include "voxid/geometry/alignment.h"

namespace voxid::cli {

struct PclPose {
  std::optional<Placement> pose;  ///< empty if nothing was found
  double us = 0;                  ///< CPU time, without the model's own points, normals and features
};

/// pcl::SampleConsensusPrerejective with FPFH features, in the settings of PCL's tutorial on rigid pose estimation
/// (5 mm voxels, 50,000 iterations), then pcl::IterativeClosestPoint of the object's points on the model's. It
/// estimates no scale and is told the true one. `seed`: of the global generator that PCL draws from; one thread at a
/// time.
PclPose poseByPcl(const ObservedObject& object, const ModelSurface& surface, float scale_mm, unsigned seed);

}  // namespace voxid::cli
