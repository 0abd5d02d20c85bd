// SPDX-License-Identifier: BSD-3-Clause
#include "rectangle.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace voxid {
namespace {

/// Smallest and largest of the hull's projections to a direction.
struct Range {
  double low = std::numeric_limits<double>::max(), high = std::numeric_limits<double>::lowest();
  void add(double x) {
    low = std::min(low, x);
    high = std::max(high, x);
  }
  double size() const { return high - low; }
  double middle() const { return (low + high) / 2; }
};

Rectangle rectangleAlong(Span<const Point2> hull, double x, double y) {
  Range along, across;
  for (const Point2& p : hull) {
    along.add(x * p.x + y * p.y);
    across.add(x * p.y - y * p.x);
  }
  Rectangle r;
  r.centre_x = x * along.middle() - y * across.middle();
  r.centre_y = y * along.middle() + x * across.middle();
  const bool longer = along.size() >= across.size();
  r.along_x = longer ? x : -y;
  r.along_y = longer ? y : x;
  r.length = longer ? along.size() : across.size();
  r.width = longer ? across.size() : along.size();
  return r;
}

}  // namespace

Rectangle smallestRectangle(Span<const Point2> hull) {
  Rectangle best = rectangleAlong(hull, 1, 0);
  for (std::size_t i = 0; i < hull.size; ++i) {
    const Point2 p = hull[i], q = hull[i + 1 < hull.size ? i + 1 : 0];
    const double dx = q.x - p.x, dy = q.y - p.y;
    const double length = std::sqrt(dx * dx + dy * dy);
    if (length < 1) continue;
    const Rectangle r = rectangleAlong(hull, dx / length, dy / length);
    if (std::floor(r.length * r.width) < std::floor(best.length * best.width)) best = r;
  }
  if (best.along_x < 0 || (best.along_x == 0 && best.along_y < 0)) {
    best.along_x = -best.along_x;
    best.along_y = -best.along_y;
  }
  return best;
}

}  // namespace voxid
