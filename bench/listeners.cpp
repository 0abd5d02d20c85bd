// SPDX-License-Identifier: BSD-3-Clause
#include "listeners.h"

#include <cstdlib>

#include "conversions.h"
#include "manager.h"

namespace voxid::bench {
namespace {

constexpr int kQueue = 200;    // this program's own delays lose nothing
constexpr int kSlice_ms = 50;  // how soon the end is noticed

std::int64_t nowUs() { return microsecondsOf(ros::Time::now()); }

/// "voxid/segmentation: frames" is of the stage segmentation; empty for what is none of ours.
std::string stageOf(const std::string& status_name) {
  const std::string ours = std::string(kNamespace).substr(1) + "/";
  if (status_name.rfind(ours, 0) != 0) return "";
  return status_name.substr(ours.size(), status_name.find(':') - ours.size());
}

double valueOf(const diagnostic_msgs::DiagnosticStatus& status, const std::string& key) {
  for (const auto& pair : status.values)
    if (pair.key == key) return std::strtod(pair.value.c_str(), nullptr);
  return 0;
}

}  // namespace

Arrivals::Arrivals(ros::NodeHandle& node, const std::string& lcm_url) : lcm_(lcm_url), hears_lcm_(lcm_.good()) {
  info_ = node.subscribe("depth/camera_info", kQueue, &Arrivals::onInfo, this);
  objects_ = node.subscribe("objects", kQueue, &Arrivals::onObjects, this, ros::TransportHints().tcpNoDelay());
  if (!hears_lcm_) return;
  lcm_.subscribe("VOXID_OBJECTS", &Arrivals::onList, this);
  lcm_thread_ = std::thread([this] {
    while (!stop_) lcm_.handleTimeout(kSlice_ms);
  });
}

Arrivals::~Arrivals() {
  info_.shutdown();
  objects_.shutdown();
  stop_ = true;
  if (lcm_thread_.joinable()) lcm_thread_.join();
}

bool Arrivals::any() {
  const std::lock_guard<std::mutex> lock(mutex_);
  for (const auto& [stamp_us, frame] : frames_)
    if (frame.ros_us > 0) return true;
  return false;
}

Frames Arrivals::frames() {
  const std::lock_guard<std::mutex> lock(mutex_);
  return frames_;
}

void Arrivals::onInfo(const sensor_msgs::CameraInfoConstPtr& info) {
  const std::lock_guard<std::mutex> lock(mutex_);
  frames_[microsecondsOf(info->header.stamp)];
}

void Arrivals::onObjects(const ObjectsConstPtr& objects) {
  const std::int64_t now_us = nowUs();
  const std::lock_guard<std::mutex> lock(mutex_);
  Frame& frame = frames_[microsecondsOf(objects->header.stamp)];
  frame.ros_us = now_us;
  frame.segment_ms = objects->segment_ms;
  frame.classify_ms = objects->classify_ms;
  frame.objects = objects->objects.size();
  for (const Object& object : objects->objects) frame.aligned += object.model_pose.status == ModelPose::ALIGNED;
}

void Arrivals::onList(const lcm::ReceiveBuffer*, const std::string&, const object_list_t* list) {
  const std::int64_t now_us = nowUs();
  const std::lock_guard<std::mutex> lock(mutex_);
  frames_[list->utime].lcm_us = now_us;
}

StageTimes::StageTimes(ros::NodeHandle& node) {
  diagnostics_ = node.subscribe("/diagnostics", kQueue, &StageTimes::onDiagnostics, this);
}

std::map<std::string, double> StageTimes::cpuMsPerFrame(std::int64_t from_us, std::int64_t to_us) {
  const std::lock_guard<std::mutex> lock(mutex_);
  std::map<std::string, double> means;
  for (const auto& [stage, reports] : reports_) {
    const Report *first = nullptr, *last = nullptr;
    for (const Report& report : reports) {
      if (report.at_us < from_us || report.at_us > to_us) continue;
      if (!first) first = &report;
      last = &report;
    }
    if (first && last->frames > first->frames)
      means[stage] = (last->cpu_ms - first->cpu_ms) / static_cast<double>(last->frames - first->frames);
  }
  return means;
}

std::string StageTimes::trouble() {
  const std::lock_guard<std::mutex> lock(mutex_);
  std::string all;
  for (const auto& [stage, sentence] : troubles_)
    if (!sentence.empty()) all += (all.empty() ? "" : "; ") + stage + ": " + sentence;
  return all;
}

void StageTimes::onDiagnostics(const diagnostic_msgs::DiagnosticArrayConstPtr& array) {
  const std::lock_guard<std::mutex> lock(mutex_);
  for (const auto& status : array->status) {
    const std::string stage = stageOf(status.name);
    if (stage.empty()) continue;
    troubles_[stage] = status.level == diagnostic_msgs::DiagnosticStatus::OK ? "" : status.message;
    const auto frames = static_cast<std::int64_t>(valueOf(status, "frames"));
    reports_[stage].push_back({microsecondsOf(array->header.stamp), valueOf(status, "cpu_ms"), frames});
  }
}

}  // namespace voxid::bench
