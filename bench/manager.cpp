// SPDX-License-Identifier: BSD-3-Clause
#include "manager.h"

#include <nodelet/loader.h>
#include <ros/ros.h>

#include <boost/make_shared.hpp>

#include "capture_nodelet.h"
#include "classification_nodelet.h"
#include "lcm_bridge_nodelet.h"
#include "overlay_nodelet.h"
#include "segmentation_nodelet.h"

namespace voxid::bench {
namespace {

/// By name and without the plugin search of ROS, so that no workspace need be sourced.
boost::shared_ptr<nodelet::Nodelet> create(const std::string& type) {
  if (type == "voxid/capture") return boost::make_shared<CaptureNodelet>();
  if (type == "voxid/segmentation") return boost::make_shared<SegmentationNodelet>();
  if (type == "voxid/classification") return boost::make_shared<ClassificationNodelet>();
  if (type == "voxid/lcm_bridge") return boost::make_shared<LcmBridgeNodelet>();
  return boost::make_shared<OverlayNodelet>();
}

}  // namespace

int runManager(int argc, char** argv) {
  ros::init(argc, argv, "manager");
  ros::console::set_logger_level(ROSCONSOLE_DEFAULT_NAME, ros::console::levels::Warn);
  ros::console::notifyLoggerLevelsChanged();
  const ros::NodeHandle node;  // ROS lives from the first handle to the last
  nodelet::Loader loader(boost::function<boost::shared_ptr<nodelet::Nodelet>(const std::string&)>{create});
  for (const std::string name : {"capture", "segmentation", "classification", "lcm_bridge", "overlay"})
    if (!loader.load(std::string(kNamespace) + "/" + name, "voxid/" + name, {}, {})) return 1;
  ros::spin();
  return 0;
}

}  // namespace voxid::bench
