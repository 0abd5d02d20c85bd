// SPDX-License-Identifier: BSD-3-Clause
// What answers to labelled queries amount to.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "queries.h"

namespace voxid::cli {

/// The answer to one query.
struct Outcome {
  std::string label;     ///< the first category; empty if nothing could be compared
  bool in_five = false;  ///< the right category is among the first five
  double seconds = 0;    ///< describing, searching and ranking
};

/// Accuracies in percent.
struct Figures {
  double top1 = 0;                     ///< queries whose first category is right
  double mean_category = 0;            ///< top1 of each category, averaged over the categories
  double top5 = 0;                     ///< queries with the right category among the first five
  double top1_low = 0, top1_high = 0;  ///< 95 % of top1 over 2,000 resamplings of the models (fixed seed)
  double us_per_query = 0;             ///< mean; reading the image is not counted
};

/// `outcomes` by query, at least one.
Figures figuresOf(const std::vector<Query>& queries, const std::vector<Outcome>& outcomes);

/// Right category a row, answer a column, darker is more (share of the row); categories by name.
cv::Mat drawConfusion(const std::vector<Query>& queries, const std::vector<Outcome>& outcomes);

}  // namespace voxid::cli
