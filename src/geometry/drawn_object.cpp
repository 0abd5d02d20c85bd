// SPDX-License-Identifier: BSD-3-Clause
#include "drawn_object.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace voxid {
namespace {

Camera cameraOf(const PixelGrid& grid) { return Camera::fromPixels(grid.fx, grid.fy, grid.cx, grid.cy); }

DepthView viewOf(const std::vector<std::uint16_t>& depth_mm, const PixelGrid& grid) {
  DepthView view;
  view.data = depth_mm.data();
  view.width_px = grid.width;
  view.height_px = grid.height;
  view.row_bytes = static_cast<std::size_t>(grid.width) * sizeof(std::uint16_t);
  view.camera = cameraOf(grid);
  return view;
}

std::uint16_t wholeMillimetres(float depth_mm) {
  constexpr float kMost = std::numeric_limits<std::uint16_t>::max();
  return static_cast<std::uint16_t>(std::lround(std::min(depth_mm, kMost)));
}

/// Every second pixel of an outline is lost, as on average in the views of an index (SensorParams::outline_loss).
bool lostAtOutline(const PixelGrid& grid, std::size_t cell) {
  return (grid.columnOf(cell) + grid.rowOf(cell)) % 2 != 0;
}

}  // namespace

ObservedObject DrawnObject::draw(const ModelSurface& surface, const Placement& pose, const Observation& seen) {
  const PixelGrid& grid = seen.grid;
  painter_.draw(surface, pose, grid);
  depth_mm_.assign(grid.size(), 0);
  pixels_.clear();
  for (std::size_t cell = 0; cell < grid.size(); ++cell) {
    const float drawn_mm = painter_.depth()[cell];
    if (!painter_.covers(cell) || (!seen.object[cell] && hides(seen.depth_mm[cell], drawn_mm))) continue;
    if (onOutline(grid, cell) && lostAtOutline(grid, cell)) continue;
    depth_mm_[cell] = wholeMillimetres(drawn_mm);
    pixels_.push_back(static_cast<std::uint32_t>(cell));
  }
  ObservedObject drawn;
  drawn.depth = viewOf(depth_mm_, grid);
  drawn.pixels = {pixels_.data(), pixels_.size()};
  return drawn;
}

bool DrawnObject::onOutline(const PixelGrid& grid, std::size_t cell) const {
  const int u = grid.columnOf(cell), v = grid.rowOf(cell);
  const auto empty = [&](int x, int y) { return !grid.contains(x, y) || !painter_.covers(grid.at(x, y)); };
  return empty(u - 1, v) || empty(u + 1, v) || empty(u, v - 1) || empty(u, v + 1);
}

}  // namespace voxid
