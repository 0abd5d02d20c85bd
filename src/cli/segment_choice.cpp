// SPDX-License-Identifier: BSD-3-Clause
#include "segment_choice.h"

#include <cctype>
#include <cmath>
#include <cstdio>

#include "settings.h"

namespace voxid::cli {

void SegmentChoice::addTo(CLI::App& app, const std::string& condition) {
  const auto help = [&](std::string text) {
    if (!condition.empty()) text[0] = static_cast<char>(std::tolower(text[0]));
    return condition + text;
  };
  app.add_option("--set", settings,
                 help("A parameter of the segmentation, name=value (doc/parameters.md); may be repeated"))
      ->type_name("NAME=VALUE")
      ->allow_extra_args(false);
  app.add_option("--up", up_text,
                 help("Direction away from the ground in the camera's frame: x right, y down, z forward"))
      ->type_name("X,Y,Z");
}

Result<SegmentParams> SegmentChoice::params() const {
  SegmentParams params;
  const Status set = applySettings(settings, params);
  if (!set.ok()) return set;
  return params;
}

Result<std::optional<Eigen::Vector3f>> SegmentChoice::up() const {
  if (up_text.empty()) return std::optional<Eigen::Vector3f>{};
  Eigen::Vector3f up(0, 0, 0);
  char rest = 0;
  const int read = std::sscanf(up_text.c_str(), "%f,%f,%f%c", &up.x(), &up.y(), &up.z(), &rest);
  const float length = up.norm();
  if (read != 3 || !std::isfinite(length) || length == 0) {
    return Status::badUse("--up " + up_text +
                          ": expected X,Y,Z, a direction in the camera's frame (x right, y down, z forward)");
  }
  return std::optional<Eigen::Vector3f>{up / length};
}

}  // namespace voxid::cli
