// SPDX-License-Identifier: BSD-3-Clause
#include "points_nodelet.h"

#include <pluginlib/class_list_macros.hpp>

#include "stopwatch.h"
#include "turns.h"

namespace voxid {

PointsNodelet::~PointsNodelet() {
  const std::lock_guard<std::mutex> turn(subscriptionTurn());
  closing_ = true;  // a listener may leave while the members go
  points_.shutdown();
}

void PointsNodelet::onInit() {
  ros::NodeHandle& node = getNodeHandle();
  health_.start(node, getPrivateNodeHandle(), getName());
  // The callback may come before advertise has returned, and then must wait for the publishers.
  const std::lock_guard<std::mutex> turn(subscriptionTurn());
  const ros::SubscriberStatusCallback changed = [this](const ros::SingleSubscriberPublisher&) { onListeners(); };
  image_ = node.advertise<sensor_msgs::Image>("depth/image_raw", 4, changed, changed);
  info_ = node.advertise<sensor_msgs::CameraInfo>("depth/camera_info", 4, changed, changed);
}

void PointsNodelet::onListeners() {
  const std::lock_guard<std::mutex> turn(subscriptionTurn());
  if (closing_) return;
  const bool wanted = image_.getNumSubscribers() + info_.getNumSubscribers() > 0;
  if (wanted == static_cast<bool>(points_)) return;
  health_.listening(wanted);
  if (wanted)
    points_ = getNodeHandle().subscribe("points", 1, &PointsNodelet::onCloud, this);
  else
    points_.shutdown();
}

void PointsNodelet::onCloud(const sensor_msgs::PointCloud2ConstPtr& cloud) {
  const Stopwatch watch;
  const auto image = images_.take();
  const auto info = infos_.take();
  const Status status = converter_.convert(*cloud, image.get(), info.get());
  if (status.ok()) {
    info_.publish(info);
    image_.publish(image);
  } else {
    health_.count("refused_clouds", 1);
  }
  health_.frame(cloud->header.stamp, status.ok() ? "OK" : "BAD_INPUT");
  health_.reason(status.ok() ? Health::Level::Ok : Health::Level::Error, status.sentence);
  health_.cost(watch.ms(), watch.cpuMs());
}

}  // namespace voxid

PLUGINLIB_EXPORT_CLASS(voxid::PointsNodelet, nodelet::Nodelet)
