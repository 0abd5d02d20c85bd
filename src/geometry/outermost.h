// SPDX-License-Identifier: BSD-3-Clause
// Which of many points can be corners of their convex hull.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "plan.h"
#include "voxid/core/span.h"

namespace voxid {

/// Points inside the octagon whose corners are the extreme points in eight directions are no corners of the hull: most
/// points, and several at a time.
class Outermost {
 public:
  void reserve(std::size_t most);
  void clear();
  /// Coordinates below 2^30.
  void add(const std::int32_t* x, const std::int32_t* y, int count);

  /// Every corner of the hull of what has been added, and few others. Valid until the next call.
  Span<const Point2> points();

 private:
  struct Extreme {
    std::int32_t farthest;
    std::size_t block;  ///< its first point
  };

  std::array<Point2, 8> extremePoints() const;

  std::vector<std::int32_t> x_, y_;
  std::vector<std::uint8_t> outside_;
  std::vector<Point2> outermost_;
};

}  // namespace voxid
