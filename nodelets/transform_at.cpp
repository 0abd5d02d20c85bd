// SPDX-License-Identifier: BSD-3-Clause
#include "transform_at.h"

#include "seconds.h"

namespace voxid {

geometry_msgs::TransformStamped transformAt(const tf2_ros::Buffer& transforms, const std::string& target,
                                            const std::string& source, const ros::Time& stamp, int tolerance_ms) {
  try {
    return transforms.lookupTransform(target, source, stamp);
  } catch (const tf2::ExtrapolationException&) {
    const geometry_msgs::TransformStamped newest = transforms.lookupTransform(target, source, ros::Time(0));
    const double late_ms = secondsBetween(newest.header.stamp, stamp) * 1000;
    if (late_ms < 0 || late_ms > tolerance_ms) throw;
    return newest;
  }
}

}  // namespace voxid
