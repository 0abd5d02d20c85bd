// SPDX-License-Identifier: BSD-3-Clause
// The paper's Figs. 5 and 6.
#pragma once

#include <opencv2/core.hpp>

#include "voxid/core/descriptor.h"

namespace voxid::cli {

/// CV_8UC3, four panels, seen from above and from the right of the camera: the grid in which lines are traced, then of
/// the lines that the Describer draws the first ones that lie ON the surface (green), OFF it (red) and both (MIXED,
/// blue), each with its share of all. `points` are at least two that differ.
cv::Mat drawLines(Span<const PointUm> points, const DescriptorParams& params);

}  // namespace voxid::cli
