// SPDX-License-Identifier: BSD-3-Clause
// `voxid eval --queries`: labelled views of single objects, answered as the robot would.
#pragma once

#include <memory>
#include <vector>

#include "evaluation.h"
#include "queries.h"
#include "recogniser.h"

namespace voxid::cli {

struct QueryEvaluation {
  Json result;                 ///< as `voxid eval --json` prints it
  std::vector<Outcome> votes;  ///< of the method vote, by query
};

/// Fails with the first query, in their order, that cannot be read. All figures but the times are the same for any
/// `jobs`.
Result<QueryEvaluation> evaluateQueries(const std::shared_ptr<const Index>& index, const std::vector<Query>& queries,
                                        const CameraChoice& camera, const SearchChoice& search, int jobs);

}  // namespace voxid::cli
