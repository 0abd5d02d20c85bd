// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/ros.h>

#include <string>

namespace voxid {

/// Says that the parameter is there, and what for nothing.
inline void sayWrongType(const ros::NodeHandle& node, const std::string& name, const std::string& expected) {
  ROS_ERROR("%s is not %s: the default is taken", node.resolveName(name).c_str(), expected.c_str());
}

inline std::string typeName(bool) { return "true or false"; }
inline std::string typeName(int) { return "a number"; }
inline std::string typeName(const std::string&) { return "text"; }

/// What the parameter server has under that name, else `otherwise`. roscpp takes a value of another type, as 1 is for
/// true, for none; here that is said.
template <typename T>
T startParam(const ros::NodeHandle& node, const std::string& name, const T& otherwise) {
  T value = otherwise;
  if (!node.getParam(name, value) && node.hasParam(name)) sayWrongType(node, name, typeName(otherwise));
  return value;
}

/// The same for those of a dynamic_reconfigure type: before its server, which writes the default over them.
template <typename Config>
void checkTypes(const ros::NodeHandle& node) {
  for (const auto& parameter : Config::__getParamDescriptions__()) {
    bool flag = false;
    int number = 0;
    const bool fits =
        parameter->type == "bool" ? node.getParam(parameter->name, flag) : node.getParam(parameter->name, number);
    if (!fits && node.hasParam(parameter->name))
      sayWrongType(node, parameter->name, parameter->type == "bool" ? typeName(flag) : typeName(number));
  }
}

}  // namespace voxid
