// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace voxid {

/// Where something stands: q = rotation * (scale * p) + translation.
struct Placement {
  Eigen::Matrix3f rotation = Eigen::Matrix3f::Identity();
  Eigen::Vector3f translation{0, 0, 0};
  float scale = 1;

  Eigen::Vector3f operator()(const Eigen::Vector3f& p) const { return rotation * (scale * p) + translation; }
};

}  // namespace voxid
