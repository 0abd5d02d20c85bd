// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_listener.h>

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>

namespace voxid {

/// Asks tf2 which way is up.
class UpDirection {
 public:
  /// `frame`: its z points up; empty: nothing is asked.
  void start(const std::string& frame);

  /// In the camera's frame, by the newest transform; never waits. None if no frame was given, or, with the reason in
  /// trouble(), if there is no transform or only one that is more than kStale_s older than the stamp.
  std::optional<Eigen::Vector3f> in(const std::string& camera_frame, const ros::Time& stamp);
  const std::string& trouble() const { return trouble_; }

  static constexpr double kStale_s = 1;

 private:
  std::string frame_, trouble_;
  std::unique_ptr<tf2_ros::Buffer> transforms_;
  std::unique_ptr<tf2_ros::TransformListener> listener_;
};

}  // namespace voxid
