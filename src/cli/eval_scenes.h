// SPDX-License-Identifier: BSD-3-Clause
// `voxid eval --scenes`: how well an index names labelled objects of real scenes.
#pragma once

#include <memory>
#include <string>

#include "compare.h"
#include "evidence.h"
#include "scene_json.h"
#include "voxid/core/index.h"

namespace voxid::cli {

struct SceneOptions {
  std::string folder;       ///< scenes, with objects.json
  std::string categories;   ///< a file: the categories that may be answers, one a line; empty: all only
  std::string aliases;      ///< a file; empty: voxid's own
  std::string look_alikes;  ///< a file; empty: voxid's own
  EvidenceChoice evidence;  ///< what counts beside the codes
  std::string models;       ///< the folder that the index was made from; for evidence that needs it
  bool comparing = false;   ///< with ESF, on the views that `compare` says
  CompareOptions compare;
};

/// JSON as `voxid eval --scenes --json` prints it.
Result<Json> evaluateScenes(const std::shared_ptr<const Index>& index, const SceneOptions& options);

/// The same for people.
void printScenes(const Json& result);

}  // namespace voxid::cli
