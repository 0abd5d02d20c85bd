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

/// Points inside the polygon whose corners are the extreme points in some directions are no corners of the hull: most
/// points, and several at a time. First it has eight corners, and then, for the few points that are left, sixteen.
class Outermost {
 public:
  void reserve(std::size_t most);

  /// Every corner of the points' hull, and few others; valid until the next call. Coordinates are below 2^29; what the
  /// arrays hold afterwards is of no use.
  Span<const Point2> of(std::int32_t* x, std::int32_t* y, std::size_t count);

 private:
  struct Extreme {
    std::int32_t farthest;
    std::size_t block;  ///< its first point
  };

  template <std::size_t kFirst>
  std::array<Point2, 8> extremePoints() const;
  template <std::size_t kCorners>
  void dropInside(const std::array<Point2, kCorners>& corners);

  std::int32_t *x_ = nullptr, *y_ = nullptr;  // the points that are left
  std::size_t count_ = 0;
  std::vector<std::uint8_t> outside_;  // by point: 1 = outside the polygon
  std::vector<Point2> outermost_;
};

}  // namespace voxid
