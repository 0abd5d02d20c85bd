// SPDX-License-Identifier: BSD-3-Clause
#include "outermost.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "../core/vectorised.h"

namespace voxid {
namespace {

/// How far a point lies in one of eight directions, counter-clockwise: along x, between x and y, along y, ...
std::int32_t along(std::size_t direction, Point2 p) {
  switch (direction) {
    case 0:
      return p.x;
    case 1:
      return p.x + p.y;
    case 2:
      return p.y;
    case 3:
      return p.y - p.x;
    case 4:
      return -p.x;
    case 5:
      return -p.x - p.y;
    case 6:
      return -p.y;
    default:
      return p.x - p.y;
  }
}

/// The largest of along() by direction.
VOXID_VECTORISED std::array<std::int32_t, 8> farthestOf(const std::int32_t* x, const std::int32_t* y, int count) {
  constexpr std::int32_t kLow = std::numeric_limits<std::int32_t>::max(),
                         kHigh = std::numeric_limits<std::int32_t>::min();
  std::int32_t low_x = kLow, low_y = kLow, low_sum = kLow, low_difference = kLow;
  std::int32_t high_x = kHigh, high_y = kHigh, high_sum = kHigh, high_difference = kHigh;
  for (int i = 0; i < count; ++i) {
    const std::int32_t sum = x[i] + y[i], difference = x[i] - y[i];
    low_x = std::min(low_x, x[i]);
    high_x = std::max(high_x, x[i]);
    low_y = std::min(low_y, y[i]);
    high_y = std::max(high_y, y[i]);
    low_sum = std::min(low_sum, sum);
    high_sum = std::max(high_sum, sum);
    low_difference = std::min(low_difference, difference);
    high_difference = std::max(high_difference, difference);
  }
  return {high_x, high_sum, high_y, -low_difference, -low_x, -low_sum, -low_y, high_difference};
}

/// Inside where across_x x + across_y y + offset > 0 for all edges, x and y counted from `origin`.
struct Octagon {
  Point2 origin;
  std::array<float, 8> across_x, across_y, offset;
};

/// Narrower by more than what floats round.
Octagon octagonThrough(const std::array<Point2, 8>& corners) {
  constexpr float kNarrower_um = 100;
  Octagon octagon;
  octagon.origin = corners[0];
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Point2 p = corners[i], q = corners[(i + 1) % corners.size()];
    const auto dx = static_cast<float>(q.x - p.x), dy = static_cast<float>(q.y - p.y);
    octagon.across_x[i] = -dy;
    octagon.across_y[i] = dx;
    octagon.offset[i] = dy * static_cast<float>(p.x - octagon.origin.x) -
                        dx * static_cast<float>(p.y - octagon.origin.y) - kNarrower_um * (std::abs(dx) + std::abs(dy));
    if (dx == 0 && dy == 0) octagon.offset[i] = 1;  // one point is the farthest in both directions: no edge
  }
  return octagon;
}

VOXID_VECTORISED void markOutside(const std::int32_t* x, const std::int32_t* y, int count, const Octagon& octagon,
                                  std::uint8_t* outside) {
  const Octagon o = octagon;
  for (int i = 0; i < count; ++i) {
    const auto px = static_cast<float>(x[i] - o.origin.x), py = static_cast<float>(y[i] - o.origin.y);
    float least = o.across_x[0] * px + o.across_y[0] * py + o.offset[0];
    for (std::size_t k = 1; k < 8; ++k) {
      const float inside = o.across_x[k] * px + o.across_y[k] * py + o.offset[k];
      least = inside < least ? inside : least;
    }
    outside[i] = static_cast<std::uint8_t>(!(least > 0));
  }
}

}  // namespace

void Outermost::reserve(std::size_t most) {
  x_.reserve(most);
  y_.reserve(most);
  outside_.reserve(most + sizeof(std::uint64_t));
  outermost_.reserve(most + 8);
}

void Outermost::clear() {
  x_.clear();
  y_.clear();
}

void Outermost::add(const std::int32_t* x, const std::int32_t* y, int count) {
  x_.insert(x_.end(), x, x + count);
  y_.insert(y_.end(), y, y + count);
}

/// The farthest point in each of the eight directions.
std::array<Point2, 8> Outermost::extremePoints() const {
  constexpr std::size_t kBlock = 256;
  std::array<Extreme, 8> extremes;
  extremes.fill({std::numeric_limits<std::int32_t>::min(), 0});
  for (std::size_t first = 0; first < x_.size(); first += kBlock) {
    const auto count = static_cast<int>(std::min(kBlock, x_.size() - first));
    const std::array<std::int32_t, 8> farthest = farthestOf(x_.data() + first, y_.data() + first, count);
    for (std::size_t i = 0; i < 8; ++i) {
      if (farthest[i] > extremes[i].farthest) extremes[i] = {farthest[i], first};
    }
  }
  std::array<Point2, 8> points;
  for (std::size_t direction = 0; direction < 8; ++direction) {
    std::size_t i = extremes[direction].block;
    while (along(direction, {x_[i], y_[i]}) != extremes[direction].farthest) ++i;
    points[direction] = {x_[i], y_[i]};
  }
  return points;
}

Span<const Point2> Outermost::points() {
  outermost_.clear();
  if (x_.empty()) return {};
  const std::array<Point2, 8> corners = extremePoints();
  outermost_.assign(corners.begin(), corners.end());
  outside_.assign(x_.size() + sizeof(std::uint64_t), 0);
  markOutside(x_.data(), y_.data(), static_cast<int>(x_.size()), octagonThrough(corners), outside_.data());
  for (std::size_t i = 0; i < x_.size();) {
    std::uint64_t eight;
    std::memcpy(&eight, outside_.data() + i, sizeof eight);
    if (eight == 0) {
      i += sizeof eight;
      continue;
    }
    if (outside_[i]) outermost_.push_back({x_[i], y_[i]});
    ++i;
  }
  return {outermost_.data(), outermost_.size()};
}

}  // namespace voxid
