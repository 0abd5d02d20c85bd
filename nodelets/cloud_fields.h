// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sensor_msgs/PointCloud2.h>

#include <cstring>

#include "voxid/core/status.h"

namespace voxid {

/// Reads x, y, z of a cloud in any layout of its fields.
class CloudFields {
 public:
  /// BadUse, with the reason, for a cloud without float32 x, y, z in little-endian order, and one shorter than its size
  /// says.
  static Result<CloudFields> of(const sensor_msgs::PointCloud2& cloud);

  float x(std::uint32_t u, std::uint32_t v) const { return value(u, v, offsets_[0]); }
  float y(std::uint32_t u, std::uint32_t v) const { return value(u, v, offsets_[1]); }
  float z(std::uint32_t u, std::uint32_t v) const { return value(u, v, offsets_[2]); }

 private:
  float value(std::uint32_t u, std::uint32_t v, std::uint32_t offset) const {
    float value;
    std::memcpy(&value, &cloud_->data[std::size_t{cloud_->row_step} * v + std::size_t{cloud_->point_step} * u + offset],
                4);
    return value;
  }

  const sensor_msgs::PointCloud2* cloud_ = nullptr;
  std::uint32_t offsets_[3] = {};
};

}  // namespace voxid
