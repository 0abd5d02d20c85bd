// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nodelet/nodelet.h>

#include <lcm/lcm-cpp.hpp>
#include <memory>
#include <string>

#include "conversions.h"
#include "health.h"

namespace voxid {

/// objects -> LCM channel VOXID_OBJECTS. Always listens: nobody can know who listens to a multicast. Parameter: ~url.
class LcmBridgeNodelet : public nodelet::Nodelet {
 public:
  static constexpr const char* kChannel = "VOXID_OBJECTS";
  static constexpr const char* kDefaultUrl = "udpm://239.255.76.67:7667?ttl=0";

 private:
  void onInit() override;
  void onObjects(const ObjectsConstPtr& objects);
  bool connected();
  void connect();

  std::string url_;
  std::unique_ptr<lcm::LCM> lcm_;
  ros::SteadyTime next_try_;
  Health health_;
  ros::Subscriber objects_;
};

}  // namespace voxid
