// SPDX-License-Identifier: BSD-3-Clause
// `voxid eval --compare`: descriptors beside one another, on the same views and the same queries.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "queries.h"
#include "scene_json.h"
#include "voxid/core/index.h"

namespace voxid::cli {

struct CompareOptions {
  std::string models;  ///< what the index was made from
  int every = 1;       ///< of the views, for all rows
  int jobs = 1;        ///< processes that render and describe
};

/// JSON as `voxid eval` prints it, with rows of each descriptor and method. Takes memory for some 5 kB a view.
Result<Json> compareDescriptors(const std::shared_ptr<const Index>& index, const std::vector<Query>& queries,
                                const CameraChoice& camera, const CompareOptions& options);

}  // namespace voxid::cli
