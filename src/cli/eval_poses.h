// SPDX-License-Identifier: BSD-3-Clause
// `voxid eval --poses`: how well poses and sizes of models are found.
#pragma once

#include <memory>
#include <string>

#include "recogniser.h"
#include "scene_json.h"
#include "voxid/core/index.h"

namespace voxid::cli {

struct PoseOptions {
  std::string models;      ///< the folder that the index was made from
  std::string unseen;      ///< a folder of other models, <category>/<model>.<ext>
  int objects = 300;       ///< views of members of the index, and as many of unseen models
  std::uint64_t seed = 1;  ///< of the views
  int jobs = 1;            ///< threads; figures do not depend on them, but for times
  int pcl_every = 0;       ///< PCL, too, is asked for each so many-th view of a member; 0 = not asked
};

/// JSON as `voxid eval --poses --json` prints it. Errors are measured on views drawn anew, whose pose is known.
Result<Json> evaluatePoses(const std::shared_ptr<const Index>& index, const SearchChoice& search,
                           const PoseOptions& options);

/// The same for people.
void printPoses(const Json& result);

}  // namespace voxid::cli
