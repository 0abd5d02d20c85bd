// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

#include "scene_json.h"

namespace voxid::cli {

/// Recall over time: the query rows of `voxid bench`, a curve each over its settings, a point where there is one only.
/// Across: recall@10, from the lowest to 1; up: median time, logarithmic.
cv::Mat drawCurves(const Json& rows);

}  // namespace voxid::cli
