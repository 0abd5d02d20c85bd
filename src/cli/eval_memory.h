// SPDX-License-Identifier: BSD-3-Clause
// `voxid eval --memory`: what several frames of an object say more than one.
#pragma once

#include <memory>
#include <string>

#include "recogniser.h"
#include "scene_json.h"

namespace voxid::cli {

struct MemoryOptions {
  std::string models;  ///< folder of models to look at, <category>/<model>.<ext>; those of other categories than the
                       ///< index's are left out
  int count = 160;     ///< of them, evenly chosen
  int jobs = 1;        ///< threads; the result is the same for any number
  SearchChoice search;
};

/// JSON as `voxid eval --memory --json` prints it. Each model is seen by a sensor on a circle of twelve frames, 30
/// degrees apart and 35 degrees above, its y axis up.
Result<Json> evaluateMemory(const std::shared_ptr<const Index>& index, const MemoryOptions& options);

/// The same for people.
void printMemory(const Json& result);

}  // namespace voxid::cli
