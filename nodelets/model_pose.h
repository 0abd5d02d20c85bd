// SPDX-License-Identifier: BSD-3-Clause
// What alignment found, as a message: pure functions.
#pragma once

#include <voxid/AlignedModel.h>
#include <voxid/ModelPose.h>

#include <Eigen/Geometry>

#include "voxid/geometry/alignment.h"
#include "voxid/geometry/symmetry.h"

namespace voxid {

/// ALIGNED, in the camera's frame; label, model and stamp are the caller's to fill. NOT_FOUND if nothing was found.
ModelPose modelPoseOf(const Alignment& alignment, const ModelSurface& surface, const Symmetry& symmetry);

/// The points of a surface; label and model are the caller's to fill.
AlignedModel alignedModelOf(const ModelSurface& surface);
constexpr int kModelPoints = 1000;

/// Moves a pose with its covariance and free axis into another frame. Other than ALIGNED: nothing.
void transform(const Eigen::Isometry3d& target_from_camera, ModelPose* model_pose);

}  // namespace voxid
