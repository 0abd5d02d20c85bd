// SPDX-License-Identifier: BSD-3-Clause
// How often the nearest category is right, by its margin over the next.
#pragma once

#include <memory>
#include <vector>

#include "voxid/core/index.h"

namespace voxid {

/// A view that is not in the index, of a model that is.
struct CalibrationQuery {
  std::uint32_t model = 0;
  std::vector<std::uint8_t> code;
};

/// Takes up to 600 of the queries, spread evenly over the categories with at least two models, and searches each
/// exactly with its own model left out. Fewer than 200 give the built-in curve.
format::Calibration calibrate(std::shared_ptr<const Index> index, const std::vector<CalibrationQuery>& queries);

/// The share of right ones in each bin, made non-decreasing (pool adjacent violators) with one right and one wrong
/// answer added to every pool; bins without samples take their lower neighbour's share, the first ones their upper's.
/// `right[i]` of `asked[i]`.
format::Calibration fitCalibration(const std::vector<int>& right, const std::vector<int>& asked);

}  // namespace voxid
