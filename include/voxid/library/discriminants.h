// SPDX-License-Identifier: BSD-3-Clause
// The map of a projection: linear discriminant analysis over views, rounded to integers.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace voxid {

/// How a code is made of bins: number k is (row k . bins + bias k) factor k / 2^24, before a code is brought to length.
struct IntegerMap {
  std::vector<std::int8_t> matrix;       ///< rows, one a number, as long as there are bins; the largest entry is 127
  std::vector<std::int32_t> bias;        ///< by row; below 2^30 in size
  std::vector<std::int32_t> factor_q24;  ///< by row; 0 to 2^31 - 1
};

/// Views to learn from, given one after another, twice, each time in the same order.
using TakeView = std::function<void(const std::string& category, const std::uint8_t* bins)>;
using ForEachView = std::function<void(const TakeView& take)>;

/// `count` directions along which categories differ most while views inside categories do not (linear discriminant
/// analysis), best first, each with the weight (between over within)^1/4; what is inside is given `shrinkage` of its
/// mean variance in every direction. Where there are fewer such directions, as of few categories, they come again from
/// the first on: distances stay in proportion, and no number of a code grows so large that it is cut. Floating point:
/// the same machine gives the same integers.
IntegerMap learnDiscriminants(const ForEachView& for_each_view, int bins, int count, double shrinkage);

}  // namespace voxid
