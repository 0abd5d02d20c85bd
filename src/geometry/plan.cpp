// SPDX-License-Identifier: BSD-3-Clause
#include "plan.h"

#include <algorithm>
#include <cmath>

#include "../core/vectorised.h"

namespace voxid {
namespace {

std::int64_t cross(Point2 o, Point2 a, Point2 b) {
  return static_cast<std::int64_t>(a.x - o.x) * (b.y - o.y) - static_cast<std::int64_t>(a.y - o.y) * (b.x - o.x);
}

/// Fewer pixels in a row than this do not make the outline: flying pixels cross the plane too.
constexpr int kShortestRun = 8;

/// A row of the image and what it shows if it shows the table.
struct TableRow {
  const std::int32_t *values, *columns;
  std::int32_t row, tolerance;

  bool shows(int u) const {
    const std::int32_t r = values[u] - (columns[u] + row);
    return (values[u] > 0) & (r <= tolerance) & (r >= -tolerance);
  }
};

VOXID_VECTORISED int anyShows(const TableRow& row, int first, int end) {
  const TableRow here = row;
  int any = 0;
  for (int u = first; u < end; ++u) any |= static_cast<int>(here.shows(u));
  return any;
}

/// First column of the first run of kShortestRun pixels on the plane, going by `step` (1 or -1) through the row's
/// `width`; -1 if none. Blocks without such a pixel are passed at once.
int firstRun(const TableRow& row, int width, int step) {
  constexpr int kBlock = 32;
  int run = 0;
  for (int i = 0; i < width; ++i) {
    const int u = step > 0 ? i : width - 1 - i;
    if (i % kBlock == 0) {
      const int last = std::clamp(u + step * (kBlock - 1), 0, width - 1);
      if (!anyShows(row, std::min(u, last), std::max(u, last) + 1)) {
        run = 0;
        i += kBlock - 1;
        continue;
      }
    }
    run = row.shows(u) ? run + 1 : 0;
    if (run == kShortestRun) return u - (kShortestRun - 1) * step;
  }
  return -1;
}

/// What the three axes of the plan add for a row's columns and for the row.
struct PlaceTerms {
  const float *x, *y, *height;
  float row_x, row_y, row_height, distance_um;
};

VOXID_VECTORISED void placeRun(const std::int32_t* inverse, const PlaceTerms& terms, int count, std::int32_t* x_um,
                               std::int32_t* y_um, std::int32_t* height_um) {
  const PlaceTerms t = terms;
#pragma GCC ivdep
  for (int i = 0; i < count; ++i) {
    const float depth_um = static_cast<float>(kUnitsTimesUm) / static_cast<float>(inverse[i]);
    x_um[i] = static_cast<std::int32_t>(depth_um * (t.x[i] + t.row_x));
    y_um[i] = static_cast<std::int32_t>(depth_um * (t.y[i] + t.row_y));
    height_um[i] = static_cast<std::int32_t>(depth_um * (t.height[i] + t.row_height) + t.distance_um);
  }
}

VOXID_VECTORISED void heightsOfRun(const std::int32_t* inverse, const float* columns, float row, float distance_um,
                                   int count, std::int32_t* height_um) {
  for (int i = 0; i < count; ++i) {
    const float depth_um = static_cast<float>(kUnitsTimesUm) / static_cast<float>(inverse[i]);
    height_um[i] = static_cast<std::int32_t>(depth_um * (columns[i] + row) + distance_um);
  }
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

void PlacedPoints::reserve(std::size_t most) {
  for (auto* coordinates : {&x_um, &y_um, &height_um}) coordinates->reserve(most);
}

void PlacedPoints::clear(std::size_t room) {
  for (auto* coordinates : {&x_um, &y_um, &height_um}) coordinates->resize(std::max(coordinates->size(), room));
  count = 0;
}

void PlanRays::reserve(int width_px, int height_px) {
  for (auto& columns : columns_) columns.reserve(static_cast<std::size_t>(width_px));
  for (auto& rows : rows_) rows.reserve(static_cast<std::size_t>(height_px));
}

void PlanRays::fill(const Rays& rays, const Plan& plan) {
  constexpr double kUnit = 1.0 / (1 << 20);
  distance_um_ = static_cast<float>(plan.distanceUm());
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d& axis = plan.axis(i);
    columns_[i].clear();
    for (const std::int32_t x : rays.x_q20) columns_[i].push_back(static_cast<float>(x * kUnit * axis.x()));
    rows_[i].clear();
    for (const std::int32_t y : rays.y_q20) rows_[i].push_back(static_cast<float>(y * kUnit * axis.y() + axis.z()));
  }
}

void PlanRays::place(const std::int32_t* inverse, int u, int v, int count, PlacedPoints& placed) const {
  const auto row = static_cast<std::size_t>(v);
  placeRun(inverse,
           {columns_[0].data() + u, columns_[1].data() + u, columns_[2].data() + u, rows_[0][row], rows_[1][row],
            rows_[2][row], distance_um_},
           count, placed.x_um.data() + placed.count, placed.y_um.data() + placed.count,
           placed.height_um.data() + placed.count);
  placed.count += static_cast<std::size_t>(count);
}

void PlanRays::heights(const std::int32_t* inverse, int u, int v, int count, std::int32_t* heights_um) const {
  heightsOfRun(inverse, columns_[2].data() + u, rows_[2][static_cast<std::size_t>(v)], distance_um_, count, heights_um);
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
    const TableRow row{inverse.row(v), sums.columns.data(), sums.rows[static_cast<std::size_t>(v)], tolerance};
    const int left = firstRun(row, inverse.width_px, 1);
    if (left < 0) continue;
    const int right = firstRun(row, inverse.width_px, -1);
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
