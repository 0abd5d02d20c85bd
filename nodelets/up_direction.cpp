// SPDX-License-Identifier: BSD-3-Clause
#include "up_direction.h"

#include "conversions.h"
#include "seconds.h"

namespace voxid {

void UpDirection::start(const std::string& frame) {
  frame_ = frame;
  if (frame_.empty()) return;
  transforms_ = std::make_unique<tf2_ros::Buffer>();
  listener_ = std::make_unique<tf2_ros::TransformListener>(*transforms_);
}

std::optional<Eigen::Vector3f> UpDirection::in(const std::string& camera_frame, const ros::Time& stamp) {
  trouble_.clear();
  if (!transforms_) return {};
  const std::string otherwise = ": the image's upward direction is taken for up";
  try {
    const auto found = transforms_->lookupTransform(camera_frame, frame_, ros::Time(0));
    const bool always = found.header.stamp.isZero();  // static transforms alone
    if (always || secondsBetween(found.header.stamp, stamp) <= kStale_s)
      return (eigenOf(found.transform).rotation() * Eigen::Vector3d::UnitZ()).cast<float>();
    trouble_ = "the transform from '" + frame_ + "' to '" + camera_frame + "' is more than a second old" + otherwise;
  } catch (const tf2::TransformException&) {
    trouble_ = "no transform from '" + frame_ + "' to '" + camera_frame + "'" + otherwise;
  }
  return {};
}

}  // namespace voxid
