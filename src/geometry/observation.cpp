// SPDX-License-Identifier: BSD-3-Clause
#include "observation.h"

#include <algorithm>
#include <cmath>

namespace voxid {
namespace {

/// Column and row of a pixel, and the box round all of them.
struct PixelBounds {
  int left = 1 << 30, top = 1 << 30, right = -1, bottom = -1;
};

PixelBounds boundsOf(const ObservedObject& object) {
  PixelBounds bounds;
  const auto width = static_cast<std::uint32_t>(object.depth.width_px);
  for (const std::uint32_t pixel : object.pixels) {
    const int u = static_cast<int>(pixel % width), v = static_cast<int>(pixel / width);
    bounds.left = std::min(bounds.left, u);
    bounds.right = std::max(bounds.right, u);
    bounds.top = std::min(bounds.top, v);
    bounds.bottom = std::max(bounds.bottom, v);
  }
  return bounds;
}

/// The part of the image that is looked at; its first pixel and every how many.
struct Cut {
  int left, top, stride;
};

Cut layGrid(const ObservedObject& object, int pixels, PixelGrid& grid) {
  const PixelBounds bounds = boundsOf(object);
  const double per_cell = static_cast<double>(object.pixels.size) / pixels;
  const int stride = std::max(1, static_cast<int>(std::lround(std::sqrt(per_cell))));
  const int margin = 4 * stride + std::max(bounds.right - bounds.left, bounds.bottom - bounds.top) / 3;
  const Cut cut{std::max(0, bounds.left - margin), std::max(0, bounds.top - margin), stride};
  grid.width = (std::min(object.depth.width_px - 1, bounds.right + margin) - cut.left) / stride + 1;
  grid.height = (std::min(object.depth.height_px - 1, bounds.bottom + margin) - cut.top) / stride + 1;
  const Camera& camera = object.depth.camera;
  const float per_px = 1 / (65536.0f * static_cast<float>(stride));
  grid.fx = static_cast<float>(camera.fx_q16) * per_px;
  grid.fy = static_cast<float>(camera.fy_q16) * per_px;
  grid.cx = static_cast<float>(camera.cx_q16) * per_px - static_cast<float>(cut.left) / static_cast<float>(stride);
  grid.cy = static_cast<float>(camera.cy_q16) * per_px - static_cast<float>(cut.top) / static_cast<float>(stride);
  return cut;
}

void markObject(const ObservedObject& object, const Cut& cut, Observation& out) {
  const auto width = static_cast<std::uint32_t>(object.depth.width_px);
  for (const std::uint32_t pixel : object.pixels) {
    const int u = static_cast<int>(pixel % width) - cut.left, v = static_cast<int>(pixel / width) - cut.top;
    if (u % cut.stride != 0 || v % cut.stride != 0) continue;
    const std::size_t cell = out.grid.at(u / cut.stride, v / cut.stride);
    if (out.depth_mm[cell] > 0) out.object[cell] = 1;
  }
}

/// Whether a cell of the object has a neighbour in its row or column that is none: the nearest to any cell outside is
/// such a one.
bool onOutline(const Observation& seen, std::size_t cell) {
  const PixelGrid& grid = seen.grid;
  const int u = grid.columnOf(cell), v = grid.rowOf(cell);
  const auto outside = [&](int x, int y) { return grid.contains(x, y) && !seen.object[grid.at(x, y)]; };
  return outside(u - 1, v) || outside(u + 1, v) || outside(u, v - 1) || outside(u, v + 1);
}

/// Every cell of the outline tells those about it how near it is.
void findNearest(Observation& out) {
  constexpr int kReach = Observation::kReach;
  const PixelGrid& grid = out.grid;
  out.nearest.assign(grid.size(), -1);
  std::vector<int> nearest_squared(grid.size(), Observation::kFar);
  for (const std::size_t cell : out.cells) {
    if (!onOutline(out, cell)) continue;
    const int u = grid.columnOf(cell), v = grid.rowOf(cell);
    for (int y = std::max(0, v - kReach); y <= std::min(grid.height - 1, v + kReach); ++y) {
      for (int x = std::max(0, u - kReach); x <= std::min(grid.width - 1, u + kReach); ++x) {
        const std::size_t to = grid.at(x, y);
        const int squared = (x - u) * (x - u) + (y - v) * (y - v);
        if (squared >= nearest_squared[to] || out.object[to]) continue;
        nearest_squared[to] = squared;
        out.nearest[to] = static_cast<int>(cell);
      }
    }
  }
}

}  // namespace

void measure(Observation& out) {
  Eigen::Vector3f sum(0, 0, 0);
  for (const std::size_t cell : out.cells) sum += out.point(cell);
  const float count = std::max(1.0f, static_cast<float>(out.cells.size()));
  out.centroid_mm = sum / count;
  float squared = 0;
  for (const std::size_t cell : out.cells) squared += (out.point(cell) - out.centroid_mm).squaredNorm();
  out.radius_mm = std::sqrt(squared / count);
}

void cutOut(const ObservedObject& object, int pixels, Observation& out) {
  const Cut cut = layGrid(object, pixels, out.grid);
  out.depth_mm.resize(out.grid.size());
  for (std::size_t cell = 0; cell < out.depth_mm.size(); ++cell) {
    const int u = cut.left + out.grid.columnOf(cell) * cut.stride, v = cut.top + out.grid.rowOf(cell) * cut.stride;
    out.depth_mm[cell] = static_cast<float>(object.depth.depthUm(u, v)) / 1000;
  }
  out.object.assign(out.grid.size(), 0);
  markObject(object, cut, out);
}

void observe(const ObservedObject& object, int pixels, Observation& out) {
  cutOut(object, pixels, out);
  out.cells.clear();
  for (std::size_t cell = 0; cell < out.object.size(); ++cell) {
    if (out.object[cell]) out.cells.push_back(cell);
  }
  measure(out);
  findNearest(out);
}

}  // namespace voxid
