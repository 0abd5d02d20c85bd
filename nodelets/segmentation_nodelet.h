// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dynamic_reconfigure/server.h>
#include <message_filters/subscriber.h>
#include <nodelet/nodelet.h>

#include <memory>
#include <mutex>
#include <vector>

#include "conversions.h"
#include "frame_sync.h"
#include "health.h"
#include "message_pool.h"
#include "params.h"
#include "up_direction.h"
#include "voxid/geometry/heights.h"
#include "voxid/geometry/segmenter.h"

namespace voxid {

/// depth/image_raw + depth/camera_info -> segments, and cloud if somebody listens to it; with ~debug also debug/table,
/// debug/above_table and debug/clusters. A busy nodelet takes the newest frame next and counts the others as dropped.
/// Parameters: params.h.
class SegmentationNodelet : public nodelet::Nodelet {
 public:
  ~SegmentationNodelet() override;

 private:
  using Frame = FrameSync<sensor_msgs::Image, sensor_msgs::CameraInfo>;

  void onInit() override;
  void onListeners();
  void unsubscribe();
  void onFrame(const sensor_msgs::ImageConstPtr& image, const sensor_msgs::CameraInfoConstPtr& info);
  void onConfig(const SegmentationConfig& config);
  boost::shared_ptr<Segments> segment(const Result<DepthView>& depth, const std_msgs::Header& header);
  void publishClouds(const DepthView& depth, const Segments& segments);
  void publishPart(const ros::Publisher& cloud, const DepthView& depth, const Segments& segments,
                   const std::vector<std::uint32_t>& pixels, int colour);
  void report(const ros::Time& stamp, const Segments& segments, const Status& input);
  SegmentParams params() const;

  bool closing_ = false;
  mutable std::mutex params_mutex_;
  SegmentParams params_;
  UpDirection up_;
  Segmenter segmenter_;
  TableAndAbove parts_;  // for the debug clouds
  MessagePool<Segments> pool_;
  Spares<Segment> spares_;
  Health health_;
  ros::Publisher segments_, cloud_;
  ros::Publisher debug_table_, debug_above_, debug_clusters_;  // advertised with ~debug only
  message_filters::Subscriber<sensor_msgs::Image> image_;
  message_filters::Subscriber<sensor_msgs::CameraInfo> info_;
  std::unique_ptr<Frame> frames_;
  std::unique_ptr<dynamic_reconfigure::Server<SegmentationConfig>> config_;
};

}  // namespace voxid
