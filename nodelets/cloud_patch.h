// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sensor_msgs/PointCloud2.h>

#include <vector>

#include "voxid/core/depth_view.h"
#include "voxid/core/span.h"
#include "voxid/core/status.h"

namespace voxid {

/// The points of one object drawn into a depth image of their own, of a camera at their origin whose pixels lie as
/// close as the points do.
class CloudPatch {
 public:
  /// BadUse, with the reason, for a cloud that CloudFields refuses and one with fewer than 20 finite points in front of
  /// the camera. More than 65,536 points are thinned evenly.
  static Result<CloudPatch> of(const sensor_msgs::PointCloud2& cloud);

  DepthView view() const;
  /// All that have depth.
  Span<const std::uint32_t> pixels() const { return {pixels_.data(), pixels_.size()}; }

 private:
  int width_px_ = 0, height_px_ = 0;
  Camera camera_;
  std::vector<float> depth_m_;
  std::vector<std::uint32_t> pixels_;
};

}  // namespace voxid
