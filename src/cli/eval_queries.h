// SPDX-License-Identifier: BSD-3-Clause
// `voxid eval --queries`: labelled views of single objects, answered as the robot would.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "evaluation.h"
#include "evidence.h"
#include "queries.h"

namespace voxid::cli {

struct QueryEvaluation {
  Json result;                 ///< as `voxid eval --json` prints it
  std::vector<Outcome> votes;  ///< of the method vote, or with alignment as evidence of that, by query
};

struct QueryOptions {
  SearchChoice search;
  EvidenceChoice evidence;
  std::string models;  ///< the folder that the index was made from; for evidence that needs it
  int jobs = 1;
};

/// With alignment as evidence there is a third row. Fails with the first query, in their order, that cannot be read.
/// All figures but the times are the same for any `jobs`.
Result<QueryEvaluation> evaluateQueries(const std::shared_ptr<const Index>& index, const std::vector<Query>& queries,
                                        const CameraChoice& camera, const QueryOptions& options);

}  // namespace voxid::cli
