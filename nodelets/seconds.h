// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/time.h>

#include <cstdint>

namespace voxid {

/// From one time to another, whatever they are: ros::Time's own difference throws beyond 68 years, and stamps come from
/// drivers.
inline double secondsBetween(const ros::Time& from, const ros::Time& to) {
  return static_cast<double>(static_cast<std::int64_t>(to.toNSec()) - static_cast<std::int64_t>(from.toNSec())) * 1e-9;
}

}  // namespace voxid
