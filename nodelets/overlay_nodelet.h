// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <message_filters/subscriber.h>
#include <nodelet/nodelet.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>
#include <visualization_msgs/MarkerArray.h>
#include <voxid/AlignedModels.h>
#include <voxid/Objects.h>
#include <voxid/Segments.h>

#include <memory>

#include "frame_sync.h"
#include "health.h"

namespace voxid {

/// For people: objects + aligned_models -> markers, and depth/image_raw + segments + objects of one stamp ->
/// overlay/image_raw. Each only while somebody listens to it.
class OverlayNodelet : public nodelet::Nodelet {
 public:
  ~OverlayNodelet() override;

 private:
  // The target frame of `objects` does not matter: what belongs together has the same stamp.
  using Frame = FrameSync<sensor_msgs::Image, sensor_msgs::CameraInfo, Segments, Objects>;

  void onInit() override;
  void onListeners();
  void listenForMarkers(bool wanted);
  void listenForOverlay(bool wanted);
  void onModels(const AlignedModelsConstPtr& models) { aligned_models_ = models; }
  void onObjects(const ObjectsConstPtr& objects);
  void onFrame(const sensor_msgs::ImageConstPtr& image, const sensor_msgs::CameraInfoConstPtr& info,
               const SegmentsConstPtr& segments, const ObjectsConstPtr& objects);

  bool closing_ = false;
  AlignedModelsConstPtr aligned_models_;  // null: none was said yet
  visualization_msgs::MarkerArray shown_;
  Health health_;
  ros::Publisher markers_, overlay_;
  ros::Subscriber marker_objects_, marker_models_;
  message_filters::Subscriber<sensor_msgs::Image> image_;
  message_filters::Subscriber<sensor_msgs::CameraInfo> info_;
  message_filters::Subscriber<Segments> segments_;
  message_filters::Subscriber<Objects> objects_;
  std::unique_ptr<Frame> frames_;
};

}  // namespace voxid
