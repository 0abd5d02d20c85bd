// SPDX-License-Identifier: BSD-3-Clause
// The paper's Table II as a picture.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "evaluation.h"
#include "queries.h"

namespace voxid::cli {

/// CV_8UC3. A row for each category that was asked for, by name; a column for each of these in the same order, then for
/// those that were only answered. Darker is a larger share of the row; green is right. At the end of a row: how many of
/// how many are right, and the category that the others are mostly taken for.
cv::Mat drawConfusion(const std::vector<Query>& queries, const std::vector<Outcome>& outcomes);

}  // namespace voxid::cli
