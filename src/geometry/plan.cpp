// SPDX-License-Identifier: BSD-3-Clause
#include "plan.h"

#include <algorithm>
#include <cmath>

namespace voxid {
namespace {

std::int64_t cross(Point2 o, Point2 a, Point2 b) {
  return static_cast<std::int64_t>(a.x - o.x) * (b.y - o.y) - static_cast<std::int64_t>(a.y - o.y) * (b.x - o.x);
}

/// Fewer pixels in a row than this do not make the outline: flying pixels cross the plane too.
constexpr int kShortestRun = 8;

/// First column of the first run of kShortestRun pixels on the plane, going by `step` from `from` to `end`; -1 if none.
int firstRun(const std::int32_t* values, const PlaneSums& sums, std::int32_t row, std::int32_t tolerance, int from,
             int end, int step) {
  int run = 0;
  for (int u = from; u != end; u += step) {
    const std::int32_t r = values[u] - (sums.columns[static_cast<std::size_t>(u)] + row);
    run = values[u] > 0 && r <= tolerance && r >= -tolerance ? run + 1 : 0;
    if (run == kShortestRun) return u - (kShortestRun - 1) * step;
  }
  return -1;
}

Eigen::Vector3d cross3(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return {a.y() * b.z() - a.z() * b.y(), a.z() * b.x() - a.x() * b.z(), a.x() * b.y() - a.y() * b.x()};
}

}  // namespace

std::size_t convexHull(Span<const Point2> sorted, Point2* hull) {
  std::size_t size = 0;
  const auto add = [&](Point2 p, std::size_t base) {
    if (size > 0 && p.x == hull[size - 1].x && p.y == hull[size - 1].y) return;
    while (size >= base + 2 && cross(hull[size - 2], hull[size - 1], p) <= 0) --size;
    hull[size++] = p;
  };
  for (std::size_t i = 0; i < sorted.size; ++i) add(sorted[i], 0);
  const std::size_t lower = size;
  for (std::size_t i = sorted.size; i-- > 0;) add(sorted[i], lower - 1);
  return size > 1 ? size - 1 : size;  // the first point came twice
}

void Rays::reserve(int width_px, int height_px) {
  x_q20.reserve(static_cast<std::size_t>(width_px));
  y_q20.reserve(static_cast<std::size_t>(height_px));
}

void Rays::fill(const Camera& camera, int width_px, int height_px) {
  const auto fillAxis = [](std::vector<std::int32_t>& axis, int size, std::int32_t f_q16, std::int32_t c_q16) {
    constexpr std::int64_t kWidest = 1 << 24;  // 16 times as far to the side as away: micrometres stay below 2^31
    axis.resize(static_cast<std::size_t>(size));
    for (int i = 0; i < size; ++i) {
      const std::int64_t offset_q16 = static_cast<std::int64_t>(i) * 65536 - c_q16;
      axis[static_cast<std::size_t>(i)] =
          static_cast<std::int32_t>(std::clamp(offset_q16 * (1 << 20) / f_q16, -kWidest, kWidest));
    }
  };
  fillAxis(x_q20, width_px, camera.fx_q16, camera.cx_q16);
  fillAxis(y_q20, height_px, camera.fy_q16, camera.cy_q16);
}

void Plan::set(const MetricPlane& table) {
  const Eigen::Vector3d& n = table.normal;
  // The image's rightward direction lies in the plane of every table that a camera sees; its downward direction
  // otherwise.
  const Eigen::Vector3d right = std::abs(n.x()) < 0.9 ? Eigen::Vector3d(1, 0, 0) : Eigen::Vector3d(0, 1, 0);
  const double along_normal = n.dot(right);
  const Eigen::Vector3d flat = right - along_normal * n;
  axis_[2] = n;
  axis_[0] = flat / std::sqrt(flat.dot(flat));
  axis_[1] = cross3(n, axis_[0]);
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) axis_q20_[i][k] = std::llround(axis_[i][k] * (1 << 20));
  }
  distance_um_ = static_cast<std::int32_t>(std::llround(table.distance_m * 1e6));
}

Eigen::Vector3d Plan::lift(double x_m, double y_m, double height_m) const {
  return direction(x_m, y_m) + (height_m - distance_um_ * 1e-6) * axis_[2];
}

void Outline::reserve(int height_px) {
  const auto most = 2 * static_cast<std::size_t>(height_px);
  ends_.reserve(most);
  hull_.reserve(2 * most);
  corners_.reserve(most);
  edges_.reserve(most);
  points_m_.reserve(most);
}

void Outline::collectRowEnds(const InverseDepth& inverse, const PlaneSums& sums, std::int32_t tolerance) {
  ends_.clear();
  for (int v = 0; v < inverse.height_px; ++v) {
    const std::int32_t row = sums.rows[static_cast<std::size_t>(v)];
    const int left = firstRun(inverse.row(v), sums, row, tolerance, 0, inverse.width_px, 1);
    if (left < 0) continue;
    const int right = firstRun(inverse.row(v), sums, row, tolerance, inverse.width_px - 1, -1, -1);
    ends_.push_back({v, left});
    ends_.push_back({v, right});
  }
}

bool Outline::fill(const InverseDepth& inverse, const PlaneSums& sums, std::int32_t tolerance, const Rays& rays,
                   const Plan& plan) {
  collectRowEnds(inverse, sums, tolerance);
  points_m_.clear();
  corners_.clear();
  edges_.clear();
  // Rows as x and columns as y: counter-clockwise is so for somebody who looks at the image.
  hull_.resize(2 * ends_.size());
  const std::size_t size = convexHull({ends_.data(), ends_.size()}, hull_.data());
  if (size < 3) return false;
  for (std::size_t i = 0; i < size; ++i) {
    const int u = hull_[i].y, v = hull_[i].x;
    const std::int32_t on_plane = sums.columns[static_cast<std::size_t>(u)] + sums.rows[static_cast<std::size_t>(v)];
    const PointUm p = rays.point(u, v, depthUmOf(std::max(on_plane, 1)));
    corners_.push_back(plan.project(p));
    points_m_.push_back(Eigen::Vector3d(p.x * 1e-6, p.y * 1e-6, p.z * 1e-6).cast<float>());
  }
  addEdges(corners_);
  return true;
}

void Outline::addEdges(const std::vector<Point2>& corners) {
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Point2 p = corners[i], q = corners[i + 1 < corners.size() ? i + 1 : 0];
    const double dx = q.x - p.x, dy = q.y - p.y;
    const double length = std::sqrt(dx * dx + dy * dy);
    if (length < 1) continue;
    const std::int64_t x_q15 = std::llround(-dy / length * 32768), y_q15 = std::llround(dx / length * 32768);
    edges_.push_back({x_q15, y_q15, x_q15 * p.x + y_q15 * p.y});
  }
}

bool Outline::contains(Point2 plan_um, std::int32_t margin_um) const {
  const std::int64_t least = -static_cast<std::int64_t>(margin_um) * 32768;
  return std::all_of(edges_.begin(), edges_.end(), [&](const Edge& edge) {
    return edge.inward_x_q15 * plan_um.x + edge.inward_y_q15 * plan_um.y - edge.offset_q15 >= least;
  });
}

}  // namespace voxid
