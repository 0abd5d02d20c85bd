// SPDX-License-Identifier: BSD-3-Clause
// How frames are segmented, as options of the commands that do it.
#pragma once

#include <CLI/CLI.hpp>
#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "voxid/core/status.h"
#include "voxid/geometry/segment_params.h"

namespace voxid::cli {

struct SegmentChoice {
  std::vector<std::string> settings;  ///< name=value
  std::string up_text;                ///< X,Y,Z; empty: not known

  void addTo(CLI::App& app, const std::string& condition);  ///< --set, --up; `condition` begins their help
  bool empty() const { return settings.empty() && up_text.empty(); }

  /// BadUse for an unknown name or a value out of range.
  Result<SegmentParams> params() const;
  /// Unit vector in the camera's frame. BadUse if it is none.
  Result<std::optional<Eigen::Vector3f>> up() const;
};

}  // namespace voxid::cli
