// SPDX-License-Identifier: BSD-3-Clause
#include "overlay_nodelet.h"

#include <sensor_msgs/fill_image.h>
#include <pluginlib/class_list_macros.hpp>

#include "conversions.h"
#include "drawing.h"
#include "stopwatch.h"
#include "turns.h"

namespace voxid {

OverlayNodelet::~OverlayNodelet() {
  const std::lock_guard<std::mutex> turn(subscriptionTurn());
  closing_ = true;  // a listener may leave while the members go
  listenForMarkers(false);
  listenForOverlay(false);
}

void OverlayNodelet::onInit() {
  ros::NodeHandle& node = getNodeHandle();
  health_.start(node, getPrivateNodeHandle(), getName());
  frames_ = std::make_unique<Frame>(8, image_, info_, segments_, objects_, this, &OverlayNodelet::onFrame,
                                    [this] { health_.dropped(); });

  // The callback may come before advertise has returned, and then must wait for the publishers.
  const std::lock_guard<std::mutex> turn(subscriptionTurn());
  const ros::SubscriberStatusCallback changed = [this](const ros::SingleSubscriberPublisher&) { onListeners(); };
  markers_ = node.advertise<visualization_msgs::MarkerArray>("markers", 2, changed, changed);
  overlay_ = node.advertise<sensor_msgs::Image>("overlay/image_raw", 2, changed, changed);
}

void OverlayNodelet::onListeners() {
  const std::lock_guard<std::mutex> turn(subscriptionTurn());
  if (closing_) return;
  const bool markers = markers_.getNumSubscribers() > 0, overlay = overlay_.getNumSubscribers() > 0;
  health_.listening(markers || overlay);
  listenForMarkers(markers);
  listenForOverlay(overlay);
}

void OverlayNodelet::listenForMarkers(bool wanted) {
  if (wanted == static_cast<bool>(marker_objects_)) return;
  if (wanted) {
    marker_models_ = getNodeHandle().subscribe("aligned_models", 1, &OverlayNodelet::onModels, this);
    marker_objects_ = getNodeHandle().subscribe("objects", 1, &OverlayNodelet::onObjects, this);
  } else {
    marker_objects_.shutdown();
    marker_models_.shutdown();
  }
}

void OverlayNodelet::listenForOverlay(bool wanted) {
  if (wanted == static_cast<bool>(objects_.getSubscriber())) return;
  if (wanted) {
    image_.subscribe(getNodeHandle(), "depth/image_raw", 8);
    info_.subscribe(getNodeHandle(), "depth/camera_info", 8);
    segments_.subscribe(getNodeHandle(), "segments", 8);
    objects_.subscribe(getNodeHandle(), "objects", 1);
  } else {
    image_.unsubscribe();
    info_.unsubscribe();
    segments_.unsubscribe();
    objects_.unsubscribe();
  }
}

void OverlayNodelet::onObjects(const ObjectsConstPtr& objects) {
  const Stopwatch watch;
  shown_ = markersOf(*objects, aligned_models_ ? *aligned_models_ : AlignedModels(), shown_);
  markers_.publish(shown_);
  health_.frame(objects->header.stamp, statusName(objects->status));
  health_.cost(watch.ms(), watch.cpuMs());
}

void OverlayNodelet::onFrame(const sensor_msgs::ImageConstPtr& image, const sensor_msgs::CameraInfoConstPtr& info,
                             const SegmentsConstPtr& segments, const ObjectsConstPtr& objects) {
  const Stopwatch watch;
  const Result<DepthView> depth = viewOf(*image, *info);
  if (!depth.ok() || !fit(*segments, depth.value)) return;
  const cv::Mat drawing = drawOverlay(depth.value, *segments, *objects);
  const auto message = boost::make_shared<sensor_msgs::Image>();
  message->header = image->header;
  sensor_msgs::fillImage(*message, sensor_msgs::image_encodings::BGR8, static_cast<std::uint32_t>(drawing.rows),
                         static_cast<std::uint32_t>(drawing.cols), static_cast<std::uint32_t>(drawing.step[0]),
                         drawing.data);
  overlay_.publish(message);
  health_.frame(image->header.stamp, statusName(objects->status));
  health_.cost(watch.ms(), watch.cpuMs());
}

}  // namespace voxid

PLUGINLIB_EXPORT_CLASS(voxid::OverlayNodelet, nodelet::Nodelet)
