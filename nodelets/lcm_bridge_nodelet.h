// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <message_filters/subscriber.h>
#include <nodelet/nodelet.h>

#include <lcm/lcm-cpp.hpp>
#include <memory>
#include <string>

#include "conversions.h"
#include "frame_sync.h"
#include "health.h"

namespace voxid {

/// objects -> LCM channel VOXID_OBJECTS; with ~points also the objects' points -> VOXID_POINTS. Always listens: nobody
/// can know who listens to a multicast. Parameters: ~url, ~points (false).
class LcmBridgeNodelet : public nodelet::Nodelet {
 public:
  static constexpr const char* kChannel = "VOXID_OBJECTS";
  static constexpr const char* kPointsChannel = "VOXID_POINTS";
  static constexpr const char* kDefaultUrl = "udpm://239.255.76.67:7667?ttl=0";

 private:
  void onInit() override;
  using Frame = FrameSync<sensor_msgs::Image, sensor_msgs::CameraInfo, Segments, Objects>;

  void listenToPoints();
  void onPoints(const sensor_msgs::ImageConstPtr& image, const sensor_msgs::CameraInfoConstPtr& info,
                const SegmentsConstPtr& segments, const ObjectsConstPtr& objects);
  void onObjects(const ObjectsConstPtr& objects);
  bool connected();
  void connect();

  std::string url_;
  std::unique_ptr<lcm::LCM> lcm_;
  ros::SteadyTime next_try_;
  Health health_;
  ros::Subscriber objects_;
  message_filters::Subscriber<sensor_msgs::Image> image_;
  message_filters::Subscriber<sensor_msgs::CameraInfo> info_;
  message_filters::Subscriber<Segments> segments_;
  message_filters::Subscriber<Objects> named_;
  std::unique_ptr<Frame> frames_;
};

}  // namespace voxid
