// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <mutex>

namespace voxid {

/// Held by a nodelet while it looks who listens, subscribes and unsubscribes: one for the whole process, because roscpp
/// loses a subscription that one thread adds to a topic while another takes the topic's last one away.
inline std::mutex& subscriptionTurn() {
  static std::mutex mutex;
  return mutex;
}

}  // namespace voxid
