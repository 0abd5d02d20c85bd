// SPDX-License-Identifier: BSD-3-Clause
#include "cloud_fields.h"

#include <algorithm>
#include <string>

namespace voxid {

Result<CloudFields> CloudFields::of(const sensor_msgs::PointCloud2& cloud) {
  if (cloud.is_bigendian) return Status::badUse("the cloud is in big-endian order, expected little-endian");
  const std::uint64_t row_bytes = std::uint64_t{cloud.point_step} * cloud.width;
  if (cloud.row_step < row_bytes || cloud.data.size() < std::uint64_t{cloud.row_step} * cloud.height)
    return Status::badUse("the cloud of " + std::to_string(cloud.width) + " x " + std::to_string(cloud.height) +
                          " points has " + std::to_string(cloud.data.size()) + " bytes: the publisher is broken");
  CloudFields fields;
  fields.cloud_ = &cloud;
  const char* const names[] = {"x", "y", "z"};
  for (int i = 0; i < 3; ++i) {
    const auto field = std::find_if(cloud.fields.begin(), cloud.fields.end(),
                                    [&](const sensor_msgs::PointField& f) { return f.name == names[i]; });
    if (field == cloud.fields.end() || field->datatype != sensor_msgs::PointField::FLOAT32 ||
        std::uint64_t{field->offset} + 4 > cloud.point_step)
      return Status::badUse(std::string("the cloud has no field '") + names[i] +
                            "' of float32: remap points to another");
    fields.offsets_[i] = field->offset;
  }
  return fields;
}

}  // namespace voxid
