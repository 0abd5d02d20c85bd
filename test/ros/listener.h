// SPDX-License-Identifier: BSD-3-Clause
// What a test hears, by stamp.
#pragma once

#include <gtest/gtest.h>
#include <ros/ros.h>

#include <boost/shared_ptr.hpp>
#include <chrono>
#include <condition_variable>
#include <map>
#include <mutex>
#include <string>

namespace voxid::test {

template <typename M>
class Listener {
 public:
  using Ptr = boost::shared_ptr<const M>;

  Listener(ros::NodeHandle node, const std::string& topic) {
    subscriber_ = node.subscribe(topic, 20, &Listener::on, this);
  }

  /// The message of that stamp; null if it has not come in time.
  Ptr wait(const ros::Time& stamp, double seconds) {
    std::unique_lock<std::mutex> lock(mutex_);
    arrived_.wait_for(lock, std::chrono::duration<double>(seconds), [&] { return heard_.count(stamp) > 0; });
    return heard_.count(stamp) ? heard_[stamp] : Ptr();
  }
  /// The first message for which `wanted` holds; null if there is none yet.
  template <typename Wanted>
  Ptr find(Wanted wanted) {
    const std::lock_guard<std::mutex> lock(mutex_);
    for (const auto& [stamp, message] : heard_)
      if (wanted(stamp)) return message;
    return Ptr();
  }
  std::size_t count() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return heard_.size();
  }

 private:
  void on(const Ptr& message) {
    const std::lock_guard<std::mutex> lock(mutex_);
    heard_[message->header.stamp] = message;
    arrived_.notify_all();
  }

  std::mutex mutex_;
  std::condition_variable arrived_;
  std::map<ros::Time, Ptr> heard_;
  ros::Subscriber subscriber_;
};

/// Tries until it is true or the time is over.
template <typename Condition>
bool eventually(double seconds, Condition condition) {
  const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(seconds);
  while (ros::WallTime::now() < end) {
    if (condition()) return true;
    ros::WallDuration(0.02).sleep();
  }
  return condition();
}

/// All tests in one life of this node: it would end with a test's last handle, and start anew under the next one.
inline int runAll() {
  const ros::NodeHandle node;
  ros::AsyncSpinner spinner(2);
  spinner.start();
  return RUN_ALL_TESTS();
}

}  // namespace voxid::test
