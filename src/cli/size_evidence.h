// SPDX-License-Identifier: BSD-3-Clause
// What size says about a category.
#pragma once

#include <cstdint>
#include <vector>

#include "nearest_codes.h"
#include "voxid/core/depth_view.h"
#include "voxid/core/index.h"

namespace voxid::cli {

/// The longest visible extent of an object, in millimetres: over 128 directions the largest spread of its points, the
/// outermost 0.3 % at either end left out. 0 if no pixel has depth.
double longestExtent_mm(const DepthView& depth, Span<const std::uint32_t> pixels);

/// The categories of an index with their least and most longest extents, as cfg/sizes.yaml has them.
class SizeTable {
 public:
  explicit SizeTable(const Index& index);

  /// Of `among` (empty: all) those that may be so long. If that leaves none, `among`: the table is then no help.
  AllowedCategories allowed(double longest_mm, const AllowedCategories& among) const;

 private:
  struct Range {
    double least_mm = 0, most_mm = 1e9;
  };
  std::vector<Range> ranges_;  // by category
};

}  // namespace voxid::cli
