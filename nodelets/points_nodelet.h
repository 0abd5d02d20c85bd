// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nodelet/nodelet.h>
#include <sensor_msgs/PointCloud2.h>

#include "cloud_depth.h"
#include "health.h"
#include "message_pool.h"

namespace voxid {

/// points (an organised PointCloud2) -> depth/image_raw + depth/camera_info, in place of a camera that publishes no
/// depth image. Only while somebody listens. What cannot be read is refused with the reason in diagnostics.
class PointsNodelet : public nodelet::Nodelet {
 public:
  ~PointsNodelet() override;

 private:
  void onInit() override;
  void onListeners();
  void onCloud(const sensor_msgs::PointCloud2ConstPtr& cloud);

  bool closing_ = false;
  CloudDepth converter_;
  MessagePool<sensor_msgs::Image> images_;
  MessagePool<sensor_msgs::CameraInfo> infos_;
  Health health_;
  ros::Publisher image_, info_;
  ros::Subscriber points_;
};

}  // namespace voxid
