// SPDX-License-Identifier: BSD-3-Clause
// A folder of labelled depth images, one object each.
#pragma once

#include <string>
#include <vector>

#include "depth_file.h"
#include "voxid/core/status.h"

namespace voxid::cli {

struct Query {
  std::string path, category, model;
};

/// Reads FOLDER/queries.csv (a header line with at least file, category and model; file relative to FOLDER; no quotes)
/// and keeps the first of each `every` lines. CannotDo for a missing file or column, or a line that is too short;
/// Damaged for an empty file; NothingFound if there is no query.
Result<std::vector<Query>> readQueries(const std::string& folder, int every);

/// FOLDER/camera_info.yaml, which goes with all images of the folder, also with those in folders of their own; without
/// it the usual choice.
CameraChoice cameraOfFolder(const std::string& folder);

}  // namespace voxid::cli
