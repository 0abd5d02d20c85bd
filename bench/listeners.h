// SPDX-License-Identifier: BSD-3-Clause
// Who listens to the chain from outside, as a robot's other programs do.
#pragma once

#include <diagnostic_msgs/DiagnosticArray.h>
#include <ros/ros.h>
#include <sensor_msgs/CameraInfo.h>
#include <voxid/Objects.h>

#include <atomic>
#include <lcm/lcm-cpp.hpp>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>
#include <voxid/object_list_t.hpp>

namespace voxid::bench {

/// One depth frame: when its messages arrived here, in microseconds since the epoch; 0 if one never did.
struct Frame {
  std::int64_t ros_us = 0, lcm_us = 0;
  float segment_ms = 0, classify_ms = 0;
  std::size_t objects = 0, aligned = 0;  ///< of them, those with their model's pose
};

/// By the stamp of the camera, in microseconds since the epoch.
using Frames = std::map<std::int64_t, Frame>;

/// Notes when `objects` arrives over ROS and over LCM, and which frames the camera published at all.
class Arrivals {
 public:
  /// `node` lies in the chain's namespace. Without a multicast route nothing comes over LCM: `hearsLcm` says so.
  Arrivals(ros::NodeHandle& node, const std::string& lcm_url);
  ~Arrivals();

  bool hearsLcm() const { return hears_lcm_; }
  bool any();
  Frames frames();

 private:
  void onInfo(const sensor_msgs::CameraInfoConstPtr& info);
  void onObjects(const ObjectsConstPtr& objects);
  void onList(const lcm::ReceiveBuffer* buffer, const std::string& channel, const object_list_t* list);

  std::mutex mutex_;
  Frames frames_;
  lcm::LCM lcm_;
  const bool hears_lcm_;
  std::atomic<bool> stop_{false};
  ros::Subscriber info_, objects_;
  std::thread lcm_thread_;
};

/// The processor time of each nodelet, as it says on /diagnostics once a second.
class StageTimes {
 public:
  struct Report {
    std::int64_t at_us = 0;  ///< of the message's stamp, since the epoch
    double cpu_ms = 0;       ///< since the nodelet began
    std::int64_t frames = 0;
  };

  explicit StageTimes(ros::NodeHandle& node);
  /// Mean processor time a frame of every stage between two times, from the reports nearest inside them.
  std::map<std::string, double> cpuMsPerFrame(std::int64_t from_us, std::int64_t to_us);
  std::string trouble();  ///< the last sentences of those that are not well; empty if all are

 private:
  void onDiagnostics(const diagnostic_msgs::DiagnosticArrayConstPtr& array);

  std::mutex mutex_;
  std::map<std::string, std::vector<Report>> reports_;
  std::map<std::string, std::string> troubles_;
  ros::Subscriber diagnostics_;
};

}  // namespace voxid::bench
