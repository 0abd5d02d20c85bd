// SPDX-License-Identifier: BSD-3-Clause
#include "plan_shape.h"

#include <Eigen/Cholesky>
#include <array>
#include <cmath>
#include <numeric>

#include "../core/vectorised.h"

namespace voxid {
namespace {

using Eigen::Vector2d;

constexpr int kStrips = 16;  // along the view, of which each shows its nearest and farthest point
constexpr int kFewestInStrip = 3, kFewestStrips = 10;
constexpr double kLargestRadius_mm = 200;
constexpr double kLeastChord = 1.1;  // of an arc, in radii: 67 degrees of it
// At 1 m. How far an arc's points lie off its circle (root mean square), beside a share of the radius; and how far the
// axes of two pieces of one thing lie apart, as seen on rendered tables. None of the cans that were put on cans and
// pots in the 77 real scenes stands as near to their axes.
constexpr double kOff_mm = 2, kOffShare = 0.02, kAxisAcross_mm = 2.5, kAxisAway_mm = 7;

struct Mean {
  std::int64_t sum = 0, count = 0;

  void add(std::int64_t x) {
    sum += x;
    ++count;
  }
  std::int64_t value() const { return count > 0 ? sum / count : 0; }
};

/// Makes x and y of points across and away.
VOXID_VECTORISED void turn(const ViewerAxes& axes, std::int32_t* x, std::int32_t* y, std::size_t count) {
  const auto away_x = static_cast<std::int32_t>(axes.away_x_q15), away_y = static_cast<std::int32_t>(axes.away_y_q15);
#pragma GCC ivdep
  for (std::size_t i = 0; i < count; ++i) {
    const std::int64_t across = static_cast<std::int64_t>(away_y) * x[i] - static_cast<std::int64_t>(away_x) * y[i];
    const std::int64_t away = static_cast<std::int64_t>(away_x) * x[i] + static_cast<std::int64_t>(away_y) * y[i];
    x[i] = static_cast<std::int32_t>(across >> 15);
    y[i] = static_cast<std::int32_t>(away >> 15);
  }
}

Extent united(const Extent& a, const Extent& b) { return {std::min(a.low, b.low), std::max(a.high, b.high)}; }
bool isWithin(const Extent& inner, const Extent& outer) { return inner.low > outer.low && inner.high < outer.high; }

/// Points of a contour, across and away, millimetres.
struct Contour {
  std::array<Vector2d, kStrips> points;
  std::size_t count = 0;

  void add(std::int32_t across_um, std::int32_t away_um) { points[count++] = Vector2d(across_um, away_um) / 1000; }
  Vector2d mean() const {
    return std::accumulate(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(count), Vector2d(0, 0)) /
           static_cast<double>(count);
  }
};

struct Contours {
  Contour front, back;
};

/// The nearest and the farthest point of each strip.
Contours contoursOf(const Extent& extent, const PlacedPoints& points) {
  struct Strip {
    int count = 0;
    std::size_t nearest = 0, farthest = 0;
  };
  const std::int32_t *const across = points.x_um.data(), *const away = points.y_um.data();
  const auto low = static_cast<std::int32_t>(extent.low);
  const float per_um = (kStrips - 0.01f) / static_cast<float>(extent.size() + 1);
  std::array<Strip, kStrips> strips;
  for (std::size_t i = 0; i < points.count; ++i) {
    Strip& strip = strips[static_cast<std::size_t>(static_cast<float>(across[i] - low) * per_um)];
    if (strip.count++ == 0) strip.nearest = strip.farthest = i;
    if (away[i] < away[strip.nearest]) strip.nearest = i;
    if (away[i] > away[strip.farthest]) strip.farthest = i;
  }
  Contours contours;
  for (const Strip& strip : strips) {
    if (strip.count < kFewestInStrip) continue;
    contours.front.add(across[strip.nearest], away[strip.nearest]);
    contours.back.add(across[strip.farthest], away[strip.farthest]);
  }
  return contours;
}

/// Least squares of x² + y² = 2 a x + 2 b y + c, linear in what is sought.
Circle fitCircle(const Contour& contour) {
  const Vector2d mean = contour.mean();
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  Eigen::Vector3d products(0, 0, 0);
  for (std::size_t i = 0; i < contour.count; ++i) {
    const Vector2d p = contour.points[i] - mean;
    const Eigen::Vector3d row(2 * p.x(), 2 * p.y(), 1);
    squares += row * row.transpose();
    products += row * p.squaredNorm();
  }
  const Eigen::Vector3d solution = squares.ldlt().solve(products);
  const Vector2d centre = solution.head<2>();
  return {centre + mean, std::sqrt(std::max(0.0, solution[2] + centre.squaredNorm())), 0};
}

double offCircle(const Circle& circle, const Vector2d& point) {
  return std::abs((point - circle.centre).norm() - circle.radius);
}

/// Leaves out the fifth that is farthest off: a handle, or a pixel between two depths.
void dropFarthest(const Circle& circle, Contour& contour) {
  std::sort(contour.points.begin(), contour.points.begin() + static_cast<std::ptrdiff_t>(contour.count),
            [&](const Vector2d& p, const Vector2d& q) { return offCircle(circle, p) < offCircle(circle, q); });
  contour.count = contour.count * 4 / 5 + 1;
}

/// Whether the points follow most of a half of the circle.
bool isArc(const Contour& contour, const Circle& circle) {
  double squares = 0, left = contour.points[0].x(), right = left;
  for (std::size_t i = 0; i < contour.count; ++i) {
    const Vector2d& p = contour.points[i];
    squares += std::pow(offCircle(circle, p), 2);
    left = std::min(left, p.x());
    right = std::max(right, p.x());
  }
  const double most_off_mm = kOff_mm * circle.distance / 1000 + kOffShare * circle.radius;
  return circle.radius <= kLargestRadius_mm && right - left >= kLeastChord * circle.radius &&
         squares <= most_off_mm * most_off_mm * static_cast<double>(contour.count);
}

/// `away`: 1 if the circle's centre lies beyond the contour, -1 if before it.
std::optional<Circle> circleOf(Contour contour, double away, double camera_height_m) {
  if (contour.count < kFewestStrips) return std::nullopt;
  dropFarthest(fitCircle(contour), contour);
  Circle circle = fitCircle(contour);
  circle.distance = std::hypot(circle.centre.norm(), 1000 * camera_height_m);
  if (away * (circle.centre.y() - contour.mean().y()) <= 0 || !isArc(contour, circle)) return std::nullopt;
  return circle;
}

/// From across and away back to the plan.
Vector2d turnedBack(const ViewerAxes& axes, const Vector2d& p) {
  const Vector2d away = Vector2d(static_cast<double>(axes.away_x_q15), static_cast<double>(axes.away_y_q15)) / 32768;
  return Vector2d(away.y(), -away.x()) * p.x() + away * p.y();
}

}  // namespace

ViewerAxes axesTowards(const PlacedPoints& points) {
  const auto sumOf = [&](const std::vector<std::int32_t>& coordinates) {
    return std::accumulate(coordinates.begin(), coordinates.begin() + static_cast<std::ptrdiff_t>(points.count),
                           std::int64_t{0});
  };
  const std::int64_t x = sumOf(points.x_um), y = sumOf(points.y_um);
  const double dx = static_cast<double>(x), dy = static_cast<double>(y);
  const double length = std::max(1.0, std::sqrt(dx * dx + dy * dy));
  return {std::llround(dx / length * 32768), std::llround(dy / length * 32768)};
}

std::int64_t overlapOf(const Extent& a, const Extent& b) { return std::min(a.high, b.high) - std::max(a.low, b.low); }

PlanShape shapeOf(const ViewerAxes& axes, PlacedPoints& points) {
  std::int32_t *const across = points.x_um.data(), *const away = points.y_um.data();
  turn(axes, across, away, points.count);
  PlanShape shape;
  for (std::size_t i = 0; i < points.count; ++i) {
    shape.across.add(across[i]);
    shape.away.add(away[i]);
  }
  Mean ends, middle;  // the outer and the inner fifths
  const std::int64_t tenth = shape.across.size() / 10 + 1;
  for (std::size_t i = 0; i < points.count; ++i) {
    const std::int64_t from_left = across[i] - shape.across.low, from_right = shape.across.high - across[i];
    if (from_left < tenth || from_right < tenth) ends.add(away[i]);
    if (from_left >= 4 * tenth && from_right >= 4 * tenth) middle.add(away[i]);
  }
  if (ends.count > 0 && middle.count > 0) shape.sagitta_um = middle.value() - ends.value();
  return shape;
}

PlanShape united(const PlanShape& a, const PlanShape& b) {
  return {united(a.across, b.across), united(a.away, b.away)};
}

bool isWithin(const PlanShape& inner, const PlanShape& outer) {
  return isWithin(inner.across, outer.across) && isWithin(inner.away, outer.away);
}

std::int64_t bulgeOf(const PlanShape& shape, const PlacedPoints& points) {
  Mean middle, around;
  const auto isMiddle = [](const Extent& extent, std::int64_t x) {
    const std::int64_t from_middle = 2 * x - extent.low - extent.high;
    return std::abs(from_middle) * 2 < extent.size();  // the inner half
  };
  for (std::size_t i = 0; i < points.count; ++i) {
    const bool inside = isMiddle(shape.across, points.x_um[i]) && isMiddle(shape.away, points.y_um[i]);
    (inside ? middle : around).add(points.height_um[i]);
  }
  return middle.value() - around.value();
}

Arcs arcsOf(double camera_height_m, PlacedPoints& points) {
  const ViewerAxes axes = axesTowards(points);
  const PlanShape shape = shapeOf(axes, points);
  const Contours contours = contoursOf(shape.across, points);
  Arcs arcs{circleOf(contours.front, 1, camera_height_m), std::nullopt};
  if (shape.sagitta_um > 0) arcs.back = circleOf(contours.back, -1, camera_height_m);
  for (std::optional<Circle>* const circle : {&arcs.front, &arcs.back})
    if (*circle) (*circle)->centre = turnedBack(axes, (*circle)->centre);
  return arcs;
}

bool areCoaxial(const Circle& a, const Circle& b) {
  const Vector2d away = (a.centre + b.centre).normalized(), apart = a.centre - b.centre;
  const double metres = std::max(a.distance, b.distance) / 1000;
  return std::abs(away.y() * apart.x() - away.x() * apart.y()) <= kAxisAcross_mm * metres &&
         std::abs(away.dot(apart)) <= kAxisAway_mm * metres;
}

bool areCoaxial(const Arcs& a, const Arcs& b) {
  const auto are = [](const std::optional<Circle>& p, const std::optional<Circle>& q) {
    return p && q && areCoaxial(*p, *q);
  };
  return are(a.front, b.front) || are(a.front, b.back) || are(a.back, b.front) || are(a.back, b.back);
}

}  // namespace voxid
