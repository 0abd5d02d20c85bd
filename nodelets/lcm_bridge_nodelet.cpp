// SPDX-License-Identifier: BSD-3-Clause
#include "lcm_bridge_nodelet.h"

#include <pluginlib/class_list_macros.hpp>

#include "start_param.h"
#include "stopwatch.h"
#include "turns.h"

namespace voxid {
namespace {

constexpr double kRetry_s = 10;  // liblcm itself prints several lines at each failure

std::string remedy(const std::string& url) {
  return "cannot send over LCM at '" + url +
         "': without a network there is no multicast route "
         "(ip link set lo up; ip route add 224.0.0.0/4 dev lo); a url looks like " +
         LcmBridgeNodelet::kDefaultUrl;
}

}  // namespace

void LcmBridgeNodelet::onInit() {
  url_ = startParam<std::string>(getPrivateNodeHandle(), "url", kDefaultUrl);
  health_.start(getNodeHandle(), getPrivateNodeHandle(), getName());
  health_.listening(true);
  connect();
  const std::lock_guard<std::mutex> turn(subscriptionTurn());
  objects_ = getNodeHandle().subscribe("objects", 2, &LcmBridgeNodelet::onObjects, this);
  if (startParam(getPrivateNodeHandle(), "points", false)) listenToPoints();
}

void LcmBridgeNodelet::listenToPoints() {
  frames_ = std::make_unique<Frame>(8, image_, info_, segments_, named_, this, &LcmBridgeNodelet::onPoints, [] {});
  image_.subscribe(getNodeHandle(), "depth/image_raw", 8);
  info_.subscribe(getNodeHandle(), "depth/camera_info", 8);
  segments_.subscribe(getNodeHandle(), "segments", 8);
  named_.subscribe(getNodeHandle(), "objects", 2);
}

/// Objects come in the order of the segments.
void LcmBridgeNodelet::onPoints(const sensor_msgs::ImageConstPtr& image, const sensor_msgs::CameraInfoConstPtr& info,
                                const SegmentsConstPtr& segments, const ObjectsConstPtr& objects) {
  const Result<DepthView> depth = viewOf(*image, *info);
  if (!depth.ok() || !fit(*segments, depth.value) || !connected()) return;
  for (std::size_t i = 0; i < std::min(segments->segments.size(), objects->objects.size()); ++i) {
    const object_points_t points = pointsOf(depth.value, *segments, segments->segments[i], objects->objects[i].number);
    if (lcm_->publish(kPointsChannel, &points) != 0) return health_.reason(Health::Level::Error, remedy(url_));
  }
}

void LcmBridgeNodelet::onObjects(const ObjectsConstPtr& objects) {
  const Stopwatch watch;
  if (!connected()) return health_.dropped();
  const object_list_t list = toLcm(*objects);
  const bool sent = lcm_->publish(kChannel, &list) == 0;
  sent ? health_.well() : health_.reason(Health::Level::Error, remedy(url_));
  sent ? health_.frame(objects->header.stamp, statusName(objects->status)) : health_.dropped();
  health_.cost(watch.ms(), watch.cpuMs());
}

bool LcmBridgeNodelet::connected() {
  if (!lcm_->good() && ros::SteadyTime::now() > next_try_) connect();
  return lcm_->good();
}

void LcmBridgeNodelet::connect() {
  lcm_ = std::make_unique<lcm::LCM>(url_);
  next_try_ = ros::SteadyTime::now() + ros::WallDuration(kRetry_s);
  lcm_->good() ? health_.well() : health_.reason(Health::Level::Error, remedy(url_));
}

}  // namespace voxid

PLUGINLIB_EXPORT_CLASS(voxid::LcmBridgeNodelet, nodelet::Nodelet)
