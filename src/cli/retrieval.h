// SPDX-License-Identifier: BSD-3-Clause
// Figures of the Princeton Shape Benchmark: how well the models of a query's category come first in a ranking.
#pragma once

#include <vector>

namespace voxid::cli {

/// Of one query, or the mean over queries: 0 to 1. C is the number of models in the library of the query's category.
struct RetrievalScore {
  double nn = 0;     ///< whether the nearest model is of the query's category
  double tier1 = 0;  ///< share of the C models that are among the first C
  double tier2 = 0;  ///< share of the C models that are among the first 2 C
  double map = 0;    ///< average precision: the mean, over the C models, of the share of right ones down to each
};

/// `right`: by rank, nearest first, the whole library: whether it is of the query's category; at least one is.
RetrievalScore scoreOf(const std::vector<bool>& right);

/// All zero without scores.
RetrievalScore meanOf(const std::vector<RetrievalScore>& scores);

/// A mean with 95 % of it over 2,000 resamplings (fixed seed).
struct MeanInterval {
  double mean = 0, low = 0, high = 0;
};

/// Of `ours` minus `theirs` in one figure of the same queries, at least one, both drawn together.
MeanInterval differenceOf(const std::vector<RetrievalScore>& ours, const std::vector<RetrievalScore>& theirs,
                          double RetrievalScore::*figure);

}  // namespace voxid::cli
