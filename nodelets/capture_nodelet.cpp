// SPDX-License-Identifier: BSD-3-Clause
#include "capture_nodelet.h"

#include <sensor_msgs/distortion_models.h>
#include <sensor_msgs/image_encodings.h>

#include <algorithm>
#include <pluginlib/class_list_macros.hpp>

#include "params.h"
#include "stopwatch.h"

namespace voxid {
namespace {

constexpr std::uint32_t kQueue = 4;

/// A serial number such as 1234 comes from a launch file as an integer.
std::string textParam(const ros::NodeHandle& node, const std::string& name) {
  int number = 0;
  if (node.getParam(name, number)) return std::to_string(number);
  return startParam<std::string>(node, name, "");
}

/// Replaces the pixels and what says how they lie.
void fillImage(const CaptureFrame& frame, sensor_msgs::Image* image) {
  image->width = static_cast<std::uint32_t>(frame.width_px);
  image->height = static_cast<std::uint32_t>(frame.height_px);
  image->step = image->width * static_cast<std::uint32_t>(frame.pixelBytes());
  image->encoding =
      frame.sensor == Sensor::Depth ? sensor_msgs::image_encodings::TYPE_16UC1 : sensor_msgs::image_encodings::RGB8;
  image->data.resize(static_cast<std::size_t>(image->step) * image->height);
  frame.copyTo(image->data.data(), image->step);
}

sensor_msgs::CameraInfoPtr pinhole(const CaptureFrame& frame, const Intrinsics& in) {
  auto info = boost::make_shared<sensor_msgs::CameraInfo>();
  info->width = static_cast<std::uint32_t>(frame.width_px);
  info->height = static_cast<std::uint32_t>(frame.height_px);
  info->distortion_model = sensor_msgs::distortion_models::PLUMB_BOB;
  info->D.assign(5, 0.0);
  info->K = {in.fx_px, 0, in.cx_px, 0, in.fy_px, in.cy_px, 0, 0, 1};
  info->R = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  info->P = {in.fx_px, 0, in.cx_px, 0, 0, in.fy_px, in.cy_px, 0, 0, 0, 1, 0};
  return info;
}

/// Never before time zero, where a simulation begins and ros::Time ends.
ros::Time arrivalTime(int offset_ms) {
  const std::int64_t ns = static_cast<std::int64_t>(ros::Time::now().toNSec()) + std::int64_t{offset_ms} * 1000000;
  return ros::Time().fromNSec(static_cast<std::uint64_t>(std::max<std::int64_t>(0, ns)));
}

std::uint8_t levelOf(CaptureState state) {
  using diagnostic_msgs::DiagnosticStatus;
  if (state == CaptureState::Lost) return DiagnosticStatus::WARN;
  return state == CaptureState::Failed ? DiagnosticStatus::ERROR : DiagnosticStatus::OK;
}

std::string summaryOf(const CaptureSnapshot& snapshot) {
  if (!snapshot.cause.empty()) return snapshot.cause;
  return snapshot.state == CaptureState::Idle ? "idle: nobody listens" : nameOf(snapshot.state);
}

}  // namespace

CaptureNodelet::~CaptureNodelet() {
  timer_.stop();  // reports and settings reach for the loop; a listener that leaves now finds none
  config_.reset();
  const std::lock_guard<std::mutex> lock(listeners_mutex_);
  loop_.reset();
}

void CaptureNodelet::onInit() {
  ros::NodeHandle& private_node = getPrivateNodeHandle();
  const std::string depth_frame = startParam<std::string>(private_node, "depth_frame_id", "voxid_depth_optical_frame");
  const bool colour = startParam(private_node, "color", false);
  setUpOutput(depth_, "depth", depth_frame, "camera_info_url");
  // Depth is registered to colour, so both are seen from one place.
  if (colour) setUpOutput(colour_, "rgb", startParam(private_node, "rgb_frame_id", depth_frame), "rgb_camera_info_url");

  CaptureLoop::Sink sink;
  sink.frame = [this](const CaptureFrame& frame, const Intrinsics& intrinsics) { onFrame(frame, intrinsics); };
  sink.lost = [this](const std::string& sentence) { NODELET_ERROR("%s", sentence.c_str()); };
  sink.recovered = [this] { NODELET_INFO("the device is back"); };
  loop_ = std::make_unique<CaptureLoop>(
      CaptureLoop::Options{textParam(private_node, "device"), colour, startParam(private_node, "loop", false)}, sink);

  checkTypes<CaptureConfig>(private_node);
  config_ = std::make_unique<dynamic_reconfigure::Server<CaptureConfig>>(private_node);
  config_->setCallback([this](CaptureConfig& config, std::uint32_t) { onConfig(config); });
  updater_ = std::make_unique<diagnostic_updater::Updater>(getNodeHandle(), private_node, getName());
  updater_->setHardwareID("none");
  updater_->add("capture", this, &CaptureNodelet::diagnose);
  timer_ = private_node.createWallTimer(ros::WallDuration(1),
                                        [this](const ros::WallTimerEvent&) { updater_->force_update(); });

  // A listener may come before advertise has returned, and then waits for the publishers.
  const std::lock_guard<std::mutex> lock(listeners_mutex_);
  advertise(depth_, "depth");
  if (colour) advertise(colour_, "rgb");
}

void CaptureNodelet::setUpOutput(Output& output, const std::string& name, const std::string& frame_id,
                                 const std::string& url_param) {
  output.frame_id = frame_id;
  const std::string url = startParam<std::string>(getPrivateNodeHandle(), url_param, "");
  if (url.empty()) return;
  const ros::NodeHandle node(getNodeHandle(), name);
  output.calibration = std::make_unique<camera_info_manager::CameraInfoManager>(node, name, url);
  if (!output.calibration->isCalibrated())
    setCalibrationProblem("~" + url_param + " " + url +
                          " cannot be used; expected file:///path or package://name/path of a "
                          "camera_info YAML; the field of view is used instead");
}

void CaptureNodelet::advertise(Output& output, const std::string& name) {
  ros::NodeHandle& node = getNodeHandle();
  const ros::SubscriberStatusCallback changed = [this](const ros::SingleSubscriberPublisher&) { onListeners(); };
  output.image = node.advertise<sensor_msgs::Image>(name + "/image_raw", kQueue, changed, changed);
  output.info = node.advertise<sensor_msgs::CameraInfo>(name + "/camera_info", kQueue, changed, changed);
}

void CaptureNodelet::onListeners() {
  const std::lock_guard<std::mutex> lock(listeners_mutex_);
  if (loop_) loop_->demand(depth_.wanted(), colour_.wanted());
}

void CaptureNodelet::onConfig(const CaptureConfig& config) {
  const CaptureParams params = paramsOf(config);
  stamp_offset_ms_ = params.stamp_offset_ms;
  loop_->setParams(params);
}

ros::Time CaptureNodelet::stampOf(const CaptureFrame& frame) {
  const bool taken_together =
      frame.sensor != last_sensor_ && frame.timestamp_us == last_timestamp_us_ && !last_stamp_.isZero();
  if (!taken_together) last_stamp_ = arrivalTime(stamp_offset_ms_);
  last_sensor_ = frame.sensor;
  last_timestamp_us_ = frame.timestamp_us;
  return last_stamp_;
}

void CaptureNodelet::onFrame(const CaptureFrame& frame, const Intrinsics& intrinsics) {
  const Stopwatch watch;
  const Output& output = frame.sensor == Sensor::Depth ? depth_ : colour_;
  const ros::Time stamp = stampOf(frame);
  const sensor_msgs::CameraInfoPtr info = infoFor(output, frame, intrinsics);
  const sensor_msgs::ImagePtr image = images_.take();
  fillImage(frame, image.get());
  image->header.stamp = info->header.stamp = stamp;
  image->header.frame_id = info->header.frame_id = output.frame_id;
  publish(output, image, info);
  const std::lock_guard<std::mutex> lock(cost_mutex_);
  cpu_ms_ += watch.cpuMs();
}

void CaptureNodelet::publish(const Output& output, const sensor_msgs::ImagePtr& image,
                             const sensor_msgs::CameraInfoPtr& info) {
  output.info.publish(info);
  output.image.publish(image);
}

sensor_msgs::CameraInfoPtr CaptureNodelet::infoFor(const Output& output, const CaptureFrame& frame,
                                                   const Intrinsics& intrinsics) {
  if (!output.calibration || !output.calibration->isCalibrated()) return pinhole(frame, intrinsics);
  auto info = boost::make_shared<sensor_msgs::CameraInfo>(output.calibration->getCameraInfo());
  if (info->width == static_cast<std::uint32_t>(frame.width_px) &&
      info->height == static_cast<std::uint32_t>(frame.height_px))
    return info;
  setCalibrationProblem("the calibration is for " + std::to_string(info->width) + " x " + std::to_string(info->height) +
                        ", the images are " + std::to_string(frame.width_px) + " x " + std::to_string(frame.height_px) +
                        "; the field of view is used instead");
  return pinhole(frame, intrinsics);
}

void CaptureNodelet::setCalibrationProblem(const std::string& sentence) {
  const std::lock_guard<std::mutex> lock(calibration_mutex_);
  if (calibration_problem_.empty()) NODELET_ERROR("%s", sentence.c_str());
  calibration_problem_ = sentence;
}

void CaptureNodelet::diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) {
  const CaptureSnapshot snapshot = loop_->snapshot();
  status.summary(levelOf(snapshot.state), summaryOf(snapshot));
  {
    const std::lock_guard<std::mutex> lock(calibration_mutex_);
    if (!calibration_problem_.empty())
      status.mergeSummary(diagnostic_msgs::DiagnosticStatus::WARN, calibration_problem_);
  }
  if (!snapshot.lacks.empty()) status.mergeSummary(diagnostic_msgs::DiagnosticStatus::WARN, snapshot.lacks);
  status.add("state", nameOf(snapshot.state));
  status.add("cause", snapshot.cause);
  status.add("device", snapshot.device);
  status.add("frames", snapshot.frames);
  status.add("bad_frames", snapshot.bad_frames);
  status.add("reconnects", snapshot.reconnects);
  status.add("cpu_ms", [this] {
    const std::lock_guard<std::mutex> lock(cost_mutex_);
    return cpu_ms_;
  }());
  if (snapshot.last_frame_age_s >= 0) status.add("last_frame_age_s", snapshot.last_frame_age_s);
}

}  // namespace voxid

PLUGINLIB_EXPORT_CLASS(voxid::CaptureNodelet, nodelet::Nodelet)
