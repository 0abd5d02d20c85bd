// SPDX-License-Identifier: BSD-3-Clause
// The pose of a named object's model, as JSON and over a picture.
#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <string>

#include "scene_json.h"
#include "voxid/core/depth_view.h"
#include "voxid/library/model_shelf.h"

namespace voxid::cli {

/// A model and where it stands.
struct ObjectPose {
  std::string model;  ///< <category>/<name>
  std::shared_ptr<const ShelvedModel> shelved;
  Alignment alignment;  ///< `found` is false if there was nothing to compare
};

/// model, rotation (quaternion x, y, z, w: model to camera), translation_mm (of the model's box centre), scale_mm (the
/// box's diagonal), fit_mm, misfit, explained, free_axis (null if the rotation is known), covariance (49 numbers, row
/// by row, as in Alignment). Null if nothing was found.
Json toJson(const ObjectPose& pose);

/// The model's surface, shaded, where nothing nearer hides it, and its outline. `picture`: CV_8UC3, of the image's
/// size.
void drawPose(const DepthView& depth, const ObjectPose& pose, const cv::Scalar& colour, cv::Mat& picture);

}  // namespace voxid::cli
