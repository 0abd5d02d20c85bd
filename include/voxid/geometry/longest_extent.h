// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "voxid/core/depth_view.h"
#include "voxid/core/span.h"

namespace voxid {

/// How long objects are. All memory is taken with the first object of a size.
class LongestExtent {
 public:
  /// Of what `pixels` (row * width + column) show, in millimetres: the largest spread over 128 directions, the
  /// outermost 0.3 % left out at either end, of at most 1,024 points, evenly chosen. 0 if no pixel has depth.
  float of_mm(const DepthView& depth, Span<const std::uint32_t> pixels);

 private:
  void choosePoints(const DepthView& depth, Span<const std::uint32_t> pixels);
  float spreadAlong(float x, float y, float z) const;

  std::vector<float> x_mm_, y_mm_, z_mm_;
};

}  // namespace voxid
