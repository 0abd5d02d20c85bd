// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <geometry_msgs/TransformStamped.h>
#include <ros/time.h>
#include <tf2_ros/buffer.h>

#include <string>

namespace voxid {

/// From `source` to `target` at `stamp`, without waiting. A robot publishes its transforms after the frames that they
/// belong to: where what is known ends up to `tolerance_ms` before the stamp, the newest is taken. Throws
/// tf2::TransformException.
geometry_msgs::TransformStamped transformAt(const tf2_ros::Buffer& transforms, const std::string& target,
                                            const std::string& source, const ros::Time& stamp, int tolerance_ms);

}  // namespace voxid
