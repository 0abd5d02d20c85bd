// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/PointCloud2.h>

#include "cloud_fields.h"
#include "voxid/core/status.h"

namespace voxid {

/// Turns an organised cloud, as RealSense, Azure Kinect and OpenNI drivers and their bags hold it, back into the depth
/// image that it was made of: 32FC1, metres, NaN where the cloud has no point. The camera follows from the points
/// themselves: column = fx x / z + cx, row = fy y / z + cy, by least squares.
class CloudDepth {
 public:
  /// Fills `image` and `info`; headers are the cloud's. BadUse, with the reason, for a cloud of one row, one without
  /// float32 x, y, z in little-endian order, one shorter than its size says, and points that no pinhole camera in an
  /// optical frame (z forward) sees in this order. A cloud of nothing but NaN keeps the camera of the one before.
  Status convert(const sensor_msgs::PointCloud2& cloud, sensor_msgs::Image* image, sensor_msgs::CameraInfo* info);

 private:
  /// pixel = focal_px * slope + centre_px, on one axis.
  struct Axis {
    double focal_px = 0, centre_px = 0, residual_px = 0;
  };
  Axis column_, row_;
  std::uint32_t width_ = 0, height_ = 0;  // that the axes were found for

  Status findCamera(const sensor_msgs::PointCloud2& cloud, const CloudFields& fields);
};

}  // namespace voxid
