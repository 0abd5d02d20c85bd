// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/ros.h>

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>

namespace voxid {

/// What a nodelet says about itself on /diagnostics once a second: state, reason, frames, drops, age of the last frame,
/// and what the frames cost.
/// A reason is logged once, when it appears, and at most once a minute where it comes and goes. Thread-safe.
class Health {
 public:
  enum class Level : std::uint8_t { Ok = 0, Warn = 1, Error = 2 };  ///< as in diagnostic_msgs/DiagnosticStatus

  /// `name` is the nodelet's resolved name.
  void start(ros::NodeHandle& node, ros::NodeHandle& private_node, const std::string& name);

  void listening(bool somebody);  ///< false: nobody subscribes, so there is no work
  void frame(const ros::Time& stamp, const std::string& status);
  /// Adds to a counter of its own name: what was dropped, and why.
  void count(const std::string& name, std::uint64_t more);
  /// Time on the clock and on processors that a frame took, publishing included.
  void cost(double ms, double cpu_ms);
  void dropped();  ///< a frame that was overtaken by a newer one, or came without its camera_info
  void reason(Level level, const std::string& sentence);
  void well() { reason(Level::Ok, ""); }

 private:
  void publish(diagnostic_updater::DiagnosticStatusWrapper& status);
  void summarise(diagnostic_updater::DiagnosticStatusWrapper& status) const;

  mutable std::mutex mutex_;
  std::string name_, reason_, logged_, last_status_;
  Level level_ = Level::Ok;
  bool listening_ = false;
  std::uint64_t frames_ = 0, dropped_ = 0;
  std::map<std::string, std::uint64_t> counts_;  // frames by status, and what count() adds to
  double last_ms_ = 0, worst_ms_ = 0, cpu_ms_ = 0;
  ros::Time last_stamp_;
  ros::SteadyTime last_arrival_, logged_at_;
  std::unique_ptr<diagnostic_updater::Updater> updater_;
  ros::WallTimer timer_;
};

}  // namespace voxid
