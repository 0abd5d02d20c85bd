// SPDX-License-Identifier: BSD-3-Clause
#include "segmentation_nodelet.h"

#include <boost/make_shared.hpp>
#include <pluginlib/class_list_macros.hpp>

#include "stopwatch.h"
#include "turns.h"

namespace voxid {
namespace {

Table tableOf(const Segments& segments) {
  Table table;
  table.normal = eigenOf(segments.table.normal).cast<float>();
  table.distance_m = segments.table.distance_m;
  return table;
}

}  // namespace

SegmentationNodelet::~SegmentationNodelet() {
  const std::lock_guard<std::mutex> turn(subscriptionTurn());
  closing_ = true;  // a listener may leave while the members go
  unsubscribe();
}

void SegmentationNodelet::onInit() {
  ros::NodeHandle& node = getNodeHandle();
  health_.start(node, getPrivateNodeHandle(), getName());
  checkTypes<SegmentationConfig>(getPrivateNodeHandle());
  config_ = std::make_unique<dynamic_reconfigure::Server<SegmentationConfig>>(getPrivateNodeHandle());
  config_->setCallback([this](SegmentationConfig& config, std::uint32_t) { onConfig(config); });
  const SegmentationStartParams at_start = segmentationStartParams(getPrivateNodeHandle());
  up_.start(at_start.up_frame);

  frames_ =
      std::make_unique<Frame>(4, image_, info_, this, &SegmentationNodelet::onFrame, [this] { health_.dropped(); });

  // The callback may come before advertise has returned, and then must wait for the publishers.
  const std::lock_guard<std::mutex> turn(subscriptionTurn());
  const ros::SubscriberStatusCallback changed = [this](const ros::SingleSubscriberPublisher&) { onListeners(); };
  segments_ = node.advertise<Segments>("segments", 2, changed, changed);
  const auto advertiseCloud = [&](const char* topic) {
    return node.advertise<sensor_msgs::PointCloud2>(topic, 1, changed, changed);
  };
  cloud_ = advertiseCloud("cloud");
  if (!at_start.debug) return;
  debug_table_ = advertiseCloud("debug/table");
  debug_above_ = advertiseCloud("debug/above_table");
  debug_clusters_ = advertiseCloud("debug/clusters");
}

void SegmentationNodelet::onListeners() {
  const std::lock_guard<std::mutex> turn(subscriptionTurn());
  if (closing_) return;
  std::uint32_t listeners = segments_.getNumSubscribers();
  for (const ros::Publisher* cloud : {&cloud_, &debug_table_, &debug_above_, &debug_clusters_})
    if (*cloud) listeners += cloud->getNumSubscribers();
  const bool wanted = listeners > 0;
  const bool subscribed = static_cast<bool>(image_.getSubscriber());
  if (wanted == subscribed) return;
  health_.listening(wanted);
  if (wanted) {
    // Images wait for their camera_info; of those only the newest is kept, so that a late frame never delays the next.
    image_.subscribe(getNodeHandle(), "depth/image_raw", 4);
    info_.subscribe(getNodeHandle(), "depth/camera_info", 1);
  } else {
    unsubscribe();
  }
}

void SegmentationNodelet::unsubscribe() {
  image_.unsubscribe();
  info_.unsubscribe();
}

void SegmentationNodelet::onFrame(const sensor_msgs::ImageConstPtr& image,
                                  const sensor_msgs::CameraInfoConstPtr& info) {
  const Stopwatch watch;
  const Result<DepthView> depth = viewOf(*image, *info);
  const auto segments = segment(depth, image->header);
  segments_.publish(segments);
  if (depth.ok()) publishClouds(depth.value, *segments);
  report(image->header.stamp, *segments, depth.status);
  health_.cost(watch.ms(), watch.cpuMs());
}

void SegmentationNodelet::report(const ros::Time& stamp, const Segments& segments, const Status& input) {
  health_.frame(stamp, statusName(segments.status));
  for (std::size_t i = 0; i < segments.dropped.size(); ++i)
    health_.count(std::string("clusters_") + nameOf(static_cast<DropReason>(i)), segments.dropped[i]);
  if (!up_.trouble().empty()) health_.count("frames_without_up", 1);
  if (!input.ok())
    health_.reason(Health::Level::Error, input.sentence);
  else
    health_.reason(up_.trouble().empty() ? Health::Level::Ok : Health::Level::Warn, up_.trouble());
}

boost::shared_ptr<Segments> SegmentationNodelet::segment(const Result<DepthView>& depth,
                                                         const std_msgs::Header& header) {
  const Stopwatch watch;
  const boost::shared_ptr<Segments> segments = pool_.take();
  segments->header = header;
  Scene unread;
  unread.status = SceneStatus::BadInput;
  const auto up = up_.in(header.frame_id, header.stamp);
  const Scene& scene = depth.ok() ? segmenter_.segment(depth.value, params(), up) : unread;
  spares_.resize(scene.clusters.size, &segments->segments);
  fillSegments(scene, depth.value.width_px, depth.value.height_px, segments.get());
  segments->segment_ms = watch.ms();
  return segments;
}

void SegmentationNodelet::publishClouds(const DepthView& depth, const Segments& segments) {
  const auto listened = [](const ros::Publisher& cloud) { return cloud && cloud.getNumSubscribers() > 0; };
  for (const ros::Publisher* coloured : {&cloud_, &debug_clusters_})
    if (listened(*coloured)) coloured->publish(boost::make_shared<sensor_msgs::PointCloud2>(cloudOf(depth, segments)));
  if (!listened(debug_table_) && !listened(debug_above_)) return;
  divide(depth, tableOf(segments), params(), parts_);
  if (listened(debug_table_)) publishPart(debug_table_, depth, segments, parts_.table, 0);
  if (listened(debug_above_)) publishPart(debug_above_, depth, segments, parts_.above, 4);
}

void SegmentationNodelet::publishPart(const ros::Publisher& cloud, const DepthView& depth, const Segments& segments,
                                      const std::vector<std::uint32_t>& pixels, int colour) {
  Segments part;
  part.header = segments.header;
  part.width = segments.width;
  part.segments.resize(1);
  part.segments[0].id = static_cast<std::uint16_t>(colour);
  if (segments.table.inliers > 0) part.segments[0].pixels = pixels;
  cloud.publish(boost::make_shared<sensor_msgs::PointCloud2>(cloudOf(depth, part)));
}

void SegmentationNodelet::onConfig(const SegmentationConfig& config) {
  const std::lock_guard<std::mutex> lock(params_mutex_);
  params_ = paramsOf(config);
}

SegmentParams SegmentationNodelet::params() const {
  const std::lock_guard<std::mutex> lock(params_mutex_);
  return params_;
}

}  // namespace voxid

PLUGINLIB_EXPORT_CLASS(voxid::SegmentationNodelet, nodelet::Nodelet)
