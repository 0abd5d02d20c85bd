// SPDX-License-Identifier: BSD-3-Clause
// `voxid eval --retrieval`: whole models as queries for whole models.
#pragma once

#include <string>

#include "scene_json.h"
#include "voxid/core/descriptor.h"

namespace voxid::cli {

/// As many lines as ESF draws: equal work, and a whole model is described once, ahead of time.
constexpr std::uint32_t kRetrievalPairs = 60000;

struct RetrievalOptions {
  std::string models, unseen;  ///< folders: what is searched, and what is asked for
  DescriptorParams params{kRetrievalPairs, DescriptorParams{}.seed};
  int jobs = 1;  ///< processes that read and describe
};

/// JSON as `voxid eval --retrieval` prints it (doc/cli.md). NothingFound if no unseen model has a category in `models`.
Result<Json> evaluateRetrieval(const RetrievalOptions& options);

/// For people.
void printRetrieval(const Json& result);

}  // namespace voxid::cli
