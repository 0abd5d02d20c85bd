// SPDX-License-Identifier: BSD-3-Clause
#include "box.h"

#include <algorithm>
#include <limits>

#include "../core/vectorised.h"
#include "rectangle.h"

namespace voxid {
namespace {

constexpr int kFewestRows = 16;  // of an object are measured, if it has them
constexpr int kColumns = 256;    // of the plan; in each only the points at either end can be corners

/// Of an object's points in the plan.
struct Sums {
  std::int64_t x = 0, y = 0, height = 0;
  std::int32_t highest_um = 0;
};

VOXID_VECTORISED Sums sumsOf(const std::int32_t* x_um, const std::int32_t* y_um, const std::int32_t* height_um,
                             std::size_t count) {
  std::int64_t x = 0, y = 0, height = 0;
  std::int32_t highest = 0;
  for (std::size_t i = 0; i < count; ++i) {
    x += x_um[i];
    y += y_um[i];
    height += height_um[i];
    highest = std::max(highest, height_um[i]);
  }
  return {x, y, height, highest};
}

bool touchesBorder(const PixelBox& box, int width_px, int height_px) {
  return box.x == 0 || box.y == 0 || box.x + box.width == width_px || box.y + box.height == height_px;
}

}  // namespace

PixelBox pixelBoxOf(Span<const Run> runs, int width_px) {
  const auto width = static_cast<std::uint32_t>(width_px);
  const std::uint32_t top = runs[0].begin / width, bottom = runs[runs.size - 1].begin / width;
  std::uint32_t left = width, right = 0;
  for (const Run& run : runs) {
    const std::uint32_t column = run.begin % width;
    left = std::min(left, column);
    right = std::max(right, column + run.size());
  }
  return {static_cast<int>(left), static_cast<int>(top), static_cast<int>(right - left),
          static_cast<int>(bottom - top) + 1};
}

BoxFitter::BoxFitter() : columns_(kColumns) {
  sorted_.reserve(2 * kColumns);
  hull_.resize(4 * kColumns);
}

void BoxFitter::reserve(std::size_t pixels) {
  placed_.reserve(pixels);
  outermost_.reserve(pixels);
}

/// Keeps, in each column of the plan, the lowest and the highest point.
void BoxFitter::bin(Span<const Point2> points) {
  constexpr Column kEmpty{{0, std::numeric_limits<std::int32_t>::max()}, {0, std::numeric_limits<std::int32_t>::min()}};
  std::fill(columns_.begin(), columns_.end(), kEmpty);
  const auto [first, last] =
      std::minmax_element(points.begin(), points.end(), [](const Point2& p, const Point2& q) { return p.x < q.x; });
  const double first_x = first->x, per_um = kColumns / (last->x - first_x + 1);
  for (const Point2& p : points) {
    Column& column =
        columns_[static_cast<std::size_t>(std::min(static_cast<int>((p.x - first_x) * per_um), kColumns - 1))];
    if (p.y < column.lowest.y) column.lowest = p;
    if (p.y > column.highest.y) column.highest = p;
  }
}

std::size_t BoxFitter::hull() {
  sorted_.clear();
  for (const Column& column : columns_) {
    if (column.lowest.y > column.highest.y) continue;
    const bool lowest_first = column.lowest.x < column.highest.x ||
                              (column.lowest.x == column.highest.x && column.lowest.y < column.highest.y);
    sorted_.push_back(lowest_first ? column.lowest : column.highest);
    sorted_.push_back(lowest_first ? column.highest : column.lowest);
  }
  return convexHull({sorted_.data(), sorted_.size()}, hull_.data());
}

/// The rows that are measured, and behind them the ends of the others; how many points the former have.
std::size_t BoxFitter::place(const Surface& surface, const Region& region, int row_step) {
  const int first_row = surface.row(region.runs[0].begin);
  const int rows = surface.row(region.runs[region.runs.size - 1].begin) - first_row + 1;
  const int step = std::clamp(rows / kFewestRows, 1, row_step);
  const auto isMeasured = [&](const Run& run) { return (surface.row(run.begin) - first_row) % step == 0; };
  placed_.clear(region.pixels);
  for (const Run& run : region.runs) {
    if (isMeasured(run)) surface.place(run, placed_);
  }
  const std::size_t measured = placed_.count;
  if (step == 1) return measured;
  for (const Run& run : region.runs) {
    if (isMeasured(run)) continue;
    surface.place({run.begin, run.begin + 1}, placed_);
    if (run.size() > 1) surface.place({run.end - 1, run.end}, placed_);
  }
  return measured;
}

void BoxFitter::fit(const Surface& surface, const Region& region, int row_step, Cluster& cluster) {
  const std::size_t measured = place(surface, region, row_step);
  cluster.box_px = pixelBoxOf(region.runs, surface.inverse.width_px);
  std::int32_t *const x_um = placed_.x_um.data(), *const y_um = placed_.y_um.data();
  const std::int32_t* const height_um = placed_.height_um.data();
  const Sums sums = sumsOf(x_um, y_um, height_um, measured);
  const Sums ends = sumsOf(x_um + measured, y_um + measured, height_um + measured, placed_.count - measured);
  cluster.truncated |= touchesBorder(cluster.box_px, surface.inverse.width_px, surface.inverse.height_px);
  const double per_point = 1e-6 / static_cast<double>(measured);
  cluster.centroid_m = surface.plan
                           .lift(static_cast<double>(sums.x) * per_point, static_cast<double>(sums.y) * per_point,
                                 static_cast<double>(sums.height) * per_point)
                           .cast<float>();

  bin(outermost_.of(x_um, y_um, placed_.count));
  const std::size_t size = hull();
  const Rectangle r = smallestRectangle({hull_.data(), size});
  const double height_m = std::max(sums.highest_um, ends.highest_um) * 1e-6;
  cluster.extents_m = Eigen::Vector3d(r.length * 1e-6, r.width * 1e-6, height_m).cast<float>();
  cluster.box_centre_m = surface.plan.lift(r.centre_x * 1e-6, r.centre_y * 1e-6, height_m / 2).cast<float>();
  cluster.axes.col(0) = surface.plan.direction(r.along_x, r.along_y).cast<float>();
  cluster.axes.col(1) = surface.plan.direction(-r.along_y, r.along_x).cast<float>();
  cluster.axes.col(2) = (surface.plan.lift(0, 0, 1) - surface.plan.lift(0, 0, 0)).cast<float>();
}

}  // namespace voxid
