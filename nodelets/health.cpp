// SPDX-License-Identifier: BSD-3-Clause
#include "health.h"

#include <algorithm>

#include "seconds.h"

namespace voxid {
namespace {

constexpr double kSilence_s = 3;  // a camera that is listened to and says nothing for so long is worth a warning

constexpr double kLogAgain_s = 60;  // what is wrong in every second frame would fill a disk in a month

void log(Health::Level level, const std::string& name, const std::string& sentence) {
  if (level == Health::Level::Error) ROS_ERROR("%s: %s", name.c_str(), sentence.c_str());
  if (level == Health::Level::Warn) ROS_WARN("%s: %s", name.c_str(), sentence.c_str());
}

}  // namespace

void Health::start(ros::NodeHandle& node, ros::NodeHandle& private_node, const std::string& name) {
  name_ = name;
  updater_ = std::make_unique<diagnostic_updater::Updater>(node, private_node, name);
  updater_->setHardwareID("none");
  updater_->add("frames", this, &Health::publish);
  timer_ = private_node.createWallTimer(ros::WallDuration(1),
                                        [this](const ros::WallTimerEvent&) { updater_->force_update(); });
}

void Health::listening(bool somebody) {
  const std::lock_guard<std::mutex> lock(mutex_);
  listening_ = somebody;
  last_arrival_ = ros::SteadyTime::now();
}

void Health::frame(const ros::Time& stamp, const std::string& status) {
  const std::lock_guard<std::mutex> lock(mutex_);
  ++frames_;
  ++counts_["frames_" + status];
  last_status_ = status;
  last_stamp_ = stamp;
  last_arrival_ = ros::SteadyTime::now();
}

void Health::count(const std::string& name, std::uint64_t more) {
  const std::lock_guard<std::mutex> lock(mutex_);
  counts_[name] += more;
}

void Health::cost(double ms, double cpu_ms) {
  const std::lock_guard<std::mutex> lock(mutex_);
  last_ms_ = ms;
  worst_ms_ = std::max(worst_ms_, ms);
  cpu_ms_ += cpu_ms;
}

void Health::dropped() {
  const std::lock_guard<std::mutex> lock(mutex_);
  ++dropped_;
}

void Health::reason(Level level, const std::string& sentence) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const ros::SteadyTime now = ros::SteadyTime::now();
  const bool just_logged = sentence == logged_ && now - logged_at_ < ros::WallDuration(kLogAgain_s);
  if (level != Level::Ok && sentence != reason_ && !just_logged) {
    log(level, name_, sentence);
    logged_ = sentence;
    logged_at_ = now;
  }
  level_ = level;
  reason_ = sentence;
}

void Health::summarise(diagnostic_updater::DiagnosticStatusWrapper& status) const {
  const double silence_s = (ros::SteadyTime::now() - last_arrival_).toSec();
  if (level_ != Level::Ok)
    status.summary(static_cast<std::uint8_t>(level_), reason_);
  else if (!listening_)
    status.summary(0, "idle: nobody listens");
  else if (silence_s > kSilence_s)
    status.summary(1, "no complete frame for more than 3 s: is the camera publishing images with camera_info?");
  else
    status.summary(0, frames_ == 0 ? "waiting for the first frame" : last_status_);
}

void Health::publish(diagnostic_updater::DiagnosticStatusWrapper& status) {
  const std::lock_guard<std::mutex> lock(mutex_);
  summarise(status);
  status.add("frames", frames_);
  status.add("dropped", dropped_);
  for (const auto& [name, count] : counts_) status.add(name, count);
  status.add("last_status", last_status_);
  status.add("last_ms", last_ms_);
  status.add("worst_ms", worst_ms_);
  status.add("cpu_ms", cpu_ms_);
  if (frames_ > 0) status.add("last_frame_age_s", secondsBetween(last_stamp_, ros::Time::now()));
}

}  // namespace voxid
