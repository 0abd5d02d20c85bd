// SPDX-License-Identifier: BSD-3-Clause
#include "outermost.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "../core/vectorised.h"
#include "flags.h"

namespace voxid {
namespace {

/// Sixteen directions, counter-clockwise; the last eight are opposite to the first.
struct Direction {
  std::int32_t x, y;
};
constexpr std::array<Direction, 16> kDirections{{{1, 0},
                                                 {2, 1},
                                                 {1, 1},
                                                 {1, 2},
                                                 {0, 1},
                                                 {-1, 2},
                                                 {-1, 1},
                                                 {-2, 1},
                                                 {-1, 0},
                                                 {-2, -1},
                                                 {-1, -1},
                                                 {-1, -2},
                                                 {0, -1},
                                                 {1, -2},
                                                 {1, -1},
                                                 {2, -1}}};

inline std::int32_t along(Direction direction, std::int32_t x, std::int32_t y) {
  return direction.x * x + direction.y * y;
}

/// The largest of along() in every second direction.
template <std::size_t kFirst>
inline std::array<std::int32_t, 8> farthestFrom(const std::int32_t* x, const std::int32_t* y, int count) {
  std::array<std::int32_t, 4> low, high;
  low.fill(std::numeric_limits<std::int32_t>::max());
  high.fill(std::numeric_limits<std::int32_t>::min());
  for (int i = 0; i < count; ++i) {
    for (std::size_t k = 0; k < 4; ++k) {
      const std::int32_t far = along(kDirections[kFirst + 2 * k], x[i], y[i]);
      low[k] = std::min(low[k], far);
      high[k] = std::max(high[k], far);
    }
  }
  return {high[0], high[1], high[2], high[3], -low[0], -low[1], -low[2], -low[3]};
}

VOXID_VECTORISED std::array<std::int32_t, 8> farthestAtEven(const std::int32_t* x, const std::int32_t* y, int count) {
  return farthestFrom<0>(x, y, count);
}

VOXID_VECTORISED std::array<std::int32_t, 8> farthestAtOdd(const std::int32_t* x, const std::int32_t* y, int count) {
  return farthestFrom<1>(x, y, count);
}

/// Inside where across_x x + across_y y + offset > 0 for all edges, x and y counted from `origin`.
template <std::size_t kCorners>
struct Polygon {
  explicit Polygon(const std::array<Point2, kCorners>& corners);

  Point2 origin;
  std::array<float, kCorners> across_x, across_y, offset;
};

/// Narrower by more than what floats round.
template <std::size_t kCorners>
Polygon<kCorners>::Polygon(const std::array<Point2, kCorners>& corners) : origin(corners[0]) {
  constexpr float kNarrower_um = 100;
  for (std::size_t i = 0; i < kCorners; ++i) {
    const Point2 p = corners[i], q = corners[(i + 1) % kCorners];
    const auto dx = static_cast<float>(q.x - p.x), dy = static_cast<float>(q.y - p.y);
    across_x[i] = -dy;
    across_y[i] = dx;
    offset[i] = dy * static_cast<float>(p.x - origin.x) - dx * static_cast<float>(p.y - origin.y) -
                kNarrower_um * (std::abs(dx) + std::abs(dy));
    if (dx == 0 && dy == 0) offset[i] = 1;  // one point is the farthest in both directions: no edge
  }
}

template <std::size_t kCorners>
inline void markOutsideOf(const Polygon<kCorners>& polygon, const std::int32_t* x, const std::int32_t* y, int count,
                          std::uint8_t* outside) {
  const Polygon<kCorners> p = polygon;
  for (int i = 0; i < count; ++i) {
    const auto px = static_cast<float>(x[i] - p.origin.x), py = static_cast<float>(y[i] - p.origin.y);
    float least = p.across_x[0] * px + p.across_y[0] * py + p.offset[0];
    for (std::size_t k = 1; k < kCorners; ++k) {
      const float inside = p.across_x[k] * px + p.across_y[k] * py + p.offset[k];
      least = inside < least ? inside : least;
    }
    outside[i] = static_cast<std::uint8_t>(!(least > 0));
  }
}

VOXID_VECTORISED void markOutside(const Polygon<8>& polygon, const std::int32_t* x, const std::int32_t* y, int count,
                                  std::uint8_t* outside) {
  markOutsideOf(polygon, x, y, count, outside);
}

VOXID_VECTORISED void markOutside(const Polygon<16>& polygon, const std::int32_t* x, const std::int32_t* y, int count,
                                  std::uint8_t* outside) {
  markOutsideOf(polygon, x, y, count, outside);
}

}  // namespace

void Outermost::reserve(std::size_t most) {
  outside_.reserve(most + kFlagsAtOnce);
  outermost_.reserve(most + 8 + 16);
}

/// The farthest point in every second direction.
template <std::size_t kFirst>
std::array<Point2, 8> Outermost::extremePoints() const {
  constexpr std::size_t kBlock = 256;
  std::array<Extreme, 8> extremes;
  extremes.fill({std::numeric_limits<std::int32_t>::min(), 0});
  for (std::size_t first = 0; first < count_; first += kBlock) {
    const auto count = static_cast<int>(std::min(kBlock, count_ - first));
    const auto farthest =
        kFirst == 0 ? farthestAtEven(x_ + first, y_ + first, count) : farthestAtOdd(x_ + first, y_ + first, count);
    for (std::size_t i = 0; i < 8; ++i) {
      if (farthest[i] > extremes[i].farthest) extremes[i] = {farthest[i], first};
    }
  }
  std::array<Point2, 8> points;
  for (std::size_t k = 0; k < 8; ++k) {
    std::size_t i = extremes[k].block;
    while (along(kDirections[kFirst + 2 * k], x_[i], y_[i]) != extremes[k].farthest) ++i;
    points[k] = {x_[i], y_[i]};
  }
  return points;
}

/// Leaves the points outside the polygon; its corners are outermost.
template <std::size_t kCorners>
void Outermost::dropInside(const std::array<Point2, kCorners>& corners) {
  outermost_.insert(outermost_.end(), corners.begin(), corners.end());
  outside_.resize(std::max(outside_.size(), count_ + kFlagsAtOnce));
  markOutside(Polygon<kCorners>(corners), x_, y_, static_cast<int>(count_), outside_.data());
  std::size_t left = 0;
  visitSet(outside_.data(), 0, count_, [&](std::size_t i) {
    x_[left] = x_[i];
    y_[left++] = y_[i];
  });
  count_ = left;
}

Span<const Point2> Outermost::of(std::int32_t* x, std::int32_t* y, std::size_t count) {
  x_ = x;
  y_ = y;
  count_ = count;
  outermost_.clear();
  if (count_ == 0) return {};
  const std::array<Point2, 8> even = extremePoints<0>();
  dropInside(even);
  if (count_ > 0) {
    const std::array<Point2, 8> odd = extremePoints<1>();
    std::array<Point2, 16> all;
    for (std::size_t k = 0; k < 8; ++k) {
      all[2 * k] = even[k];
      all[2 * k + 1] = odd[k];
    }
    dropInside(all);
  }
  for (std::size_t i = 0; i < count_; ++i) outermost_.push_back({x_[i], y_[i]});
  return {outermost_.data(), outermost_.size()};
}

}  // namespace voxid
