// SPDX-License-Identifier: BSD-3-Clause
// A nodelet as a plain node: the same class, loaded into a process of its own.
#include <nodelet/loader.h>
#include <ros/ros.h>

int main(int argc, char** argv) {
  ros::init(argc, argv, VOXID_NODE);
  nodelet::Loader loader;
  const nodelet::V_string arguments(argv + 1, argv + argc);
  if (!loader.load(ros::this_node::getName(), VOXID_NODELET, ros::names::getRemappings(), arguments)) {
    ROS_FATAL("voxid: cannot load the nodelet " VOXID_NODELET
              ": is the workspace's setup.bash (or scripts/env.sh) sourced in this shell?");
    return 1;
  }
  ros::spin();
  return 0;
}
