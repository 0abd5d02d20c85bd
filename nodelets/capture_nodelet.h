// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <camera_info_manager/camera_info_manager.h>
#include <diagnostic_updater/diagnostic_updater.h>
#include <dynamic_reconfigure/server.h>
#include <nodelet/nodelet.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>
#include <voxid/CaptureConfig.h>

#include <atomic>
#include <memory>
#include <mutex>
#include <string>

#include "message_pool.h"
#include "voxid/capture/capture_loop.h"

namespace voxid {

/// Publishes what an OpenNI2 device sees while somebody listens: depth/image_raw (16UC1, mm), depth/camera_info and,
/// with ~color, rgb/image_raw (rgb8), rgb/camera_info. Colour and depth that the device took together have one stamp.
class CaptureNodelet : public nodelet::Nodelet {
 public:
  ~CaptureNodelet() override;

 protected:
  /// The two topics of a sensor.
  struct Output {
    std::string frame_id;
    std::unique_ptr<camera_info_manager::CameraInfoManager> calibration;  ///< only with a camera_info_url
    ros::Publisher image, info;

    bool wanted() const { return image.getNumSubscribers() > 0 || info.getNumSubscribers() > 0; }
  };

  /// Hands the messages out by pointer: who listens in the same manager gets this very image.
  virtual void publish(const Output& output, const sensor_msgs::ImagePtr& image,
                       const sensor_msgs::CameraInfoPtr& info);

 private:
  void onInit() override;
  void setUpOutput(Output& output, const std::string& name, const std::string& frame_id, const std::string& url_param);
  void advertise(Output& output, const std::string& name);
  void onListeners();
  void onConfig(const CaptureConfig& config);
  void onFrame(const CaptureFrame& frame, const Intrinsics& intrinsics);
  ros::Time stampOf(const CaptureFrame& frame);
  sensor_msgs::CameraInfoPtr infoFor(const Output& output, const CaptureFrame& frame, const Intrinsics& intrinsics);
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status);
  void setCalibrationProblem(const std::string& sentence);

  std::mutex listeners_mutex_;
  std::unique_ptr<CaptureLoop> loop_;  // after the destructor's body null, and there until the publishers are gone
  Output depth_, colour_;
  std::atomic<int> stamp_offset_ms_{0};
  std::mutex cost_mutex_;
  double cpu_ms_ = 0;  // of the loop's thread, copying and publishing
  std::mutex calibration_mutex_;
  std::string calibration_problem_;
  std::unique_ptr<dynamic_reconfigure::Server<CaptureConfig>> config_;
  std::unique_ptr<diagnostic_updater::Updater> updater_;
  ros::WallTimer timer_;

  // The loop's thread only.
  MessagePool<sensor_msgs::Image> images_;
  ros::Time last_stamp_;
  std::uint64_t last_timestamp_us_ = 0;
  Sensor last_sensor_ = Sensor::Depth;
};

}  // namespace voxid
