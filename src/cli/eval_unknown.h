// SPDX-License-Identifier: BSD-3-Clause
// `voxid eval --unknown`: whether the score of an answer says how likely it is right, and whether it is low for objects
// of categories that the index does not have.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "queries.h"
#include "scene_json.h"
#include "voxid/core/index.h"

namespace voxid::cli {

struct UnknownOptions {
  std::string models;  ///< folder that the index was made from; empty: not compared with it
  std::string plot;    ///< a picture to draw; empty: none
  int jobs = 1;        ///< threads; the result is the same for any number
};

/// JSON as `voxid eval --unknown --json` prints it. Every query is answered five times: from the whole index, and four
/// times with a quarter of its categories left out of the search (by their names' CRC-32C, modulo four). Fails as
/// evaluateQueries does; CannotDo if `models` lacks a category of the index.
Result<Json> evaluateUnknown(const std::shared_ptr<const Index>& index, const std::vector<Query>& queries,
                             const CameraChoice& camera, const UnknownOptions& options);

/// The same for people.
void printUnknown(const Json& result);

}  // namespace voxid::cli
