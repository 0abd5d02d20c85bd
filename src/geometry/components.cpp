// SPDX-License-Identifier: BSD-3-Clause
#include "components.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

namespace voxid {
namespace {

/// Whether a pixel belongs to something on the table: both its height and its inverse depth differ enough.
struct HeightTest {
  HeightTest(double distance_m, const SegmentParams& params)
      : margin(params.min_margin_per_km * kUnitsPerKm),
        distance_um(std::llround(distance_m * 1e6)),
        lowest_um(params.min_height_mm * 1000),
        highest_um(params.max_height_mm * 1000) {}

  /// Height = distance (1 - expected / value): compared without a division.
  bool operator()(std::int32_t value, std::int32_t expected) const {
    if (value - expected <= margin || value == 0) return false;
    const std::int64_t scaled = static_cast<std::int64_t>(value - expected) * distance_um;
    return scaled > lowest_um * value && scaled <= highest_um * value;
  }

  std::int32_t margin;
  std::int64_t distance_um, lowest_um, highest_um;
};

}  // namespace

void Components::reserve(std::size_t pixels, int width_px) {
  node_of_.reserve(pixels);
  last_in_column_.reserve(static_cast<std::size_t>(width_px));
  pixel_.reserve(pixels);
  parent_.reserve(pixels);
  point_.reserve(pixels);
  part_of_.reserve(pixels);
  first_.reserve(pixels + 1);
  sorted_pixels_.reserve(pixels);
}

void Components::clear(std::size_t pixels, int width_px) {
  node_of_.assign(pixels, -1);
  last_in_column_.assign(static_cast<std::size_t>(width_px), -1);
  pixel_.clear();
  parent_.clear();
  point_.clear();
}

std::uint32_t Components::rootOf(std::uint32_t node) {
  while (parent_[node] != node) {
    parent_[node] = parent_[parent_[node]];
    node = parent_[node];
  }
  return node;
}

/// The earlier root stays: a part's root is its first pixel.
void Components::unite(std::uint32_t a, std::uint32_t b) {
  a = rootOf(a);
  b = rootOf(b);
  parent_[std::max(a, b)] = std::min(a, b);
}

void Components::uniteParts(std::size_t a, std::size_t b) {
  unite(static_cast<std::uint32_t>(node_of_[sorted_pixels_[first_[a]]]),
        static_cast<std::uint32_t>(node_of_[sorted_pixels_[first_[b]]]));
}

void Components::splitPart(std::size_t part, Span<const std::uint8_t> numbers) {
  std::array<std::int32_t, 256> root_of;
  root_of.fill(-1);
  const Span<const std::uint32_t> pixels = pixelsOf(part);
  for (std::size_t i = 0; i < pixels.size; ++i) {
    const std::int32_t node = node_of_[pixels[i]];
    std::int32_t& root = root_of[numbers[i]];
    if (root < 0) root = node;
    parent_[static_cast<std::size_t>(node)] = static_cast<std::uint32_t>(root);
  }
}

bool Components::nearInSpace(std::uint32_t a, std::uint32_t b) const {
  const std::int64_t dx = point_[a].x - point_[b].x, dy = point_[a].y - point_[b].y, dz = point_[a].z - point_[b].z;
  return dx * dx + dy * dy + dz * dz < static_cast<std::int64_t>(gap_um_) * gap_um_;
}

void Components::linkIfNear(std::uint32_t node, std::int32_t other) {
  if (other < 0) return;
  const auto o = static_cast<std::uint32_t>(other);
  if (std::abs(point_[node].z - point_[o].z) < gap_um_) unite(node, o);
}

/// The four of the eight neighbours that the scan has passed.
void Components::linkNeighbours(std::uint32_t node, int u, int v, int width_px) {
  const std::int32_t* here = node_of_.data() + static_cast<std::size_t>(v) * width_px + u;
  if (u > 0) linkIfNear(node, here[-1]);
  if (v == 0) return;
  linkIfNear(node, here[-width_px]);
  if (u > 0) linkIfNear(node, here[-width_px - 1]);
  if (u + 1 < width_px) linkIfNear(node, here[-width_px + 1]);
}

/// The nodes before it along row and column, over holes of at most bridge_px.
void Components::linkOverHoles(std::uint32_t node, int u, int width_px, std::int32_t& last_in_row) {
  std::int32_t& last_in_column = last_in_column_[static_cast<std::size_t>(u)];
  const auto linkAlong = [&](std::int32_t last, std::uint32_t pixels_per_step) {
    if (last < 0) return;
    const auto earlier = static_cast<std::uint32_t>(last);
    const std::uint32_t steps = (pixel_[node] - pixel_[earlier]) / pixels_per_step;
    if (steps > 1 && steps <= farthest_link_ && nearInSpace(node, earlier)) unite(node, earlier);
  };
  linkAlong(last_in_row, 1);
  linkAlong(last_in_column, static_cast<std::uint32_t>(width_px));
  last_in_row = last_in_column = static_cast<std::int32_t>(node);
}

void Components::add(const Surface& surface, int u, int v, std::int32_t& last_in_row) {
  const int width = surface.inverse.width_px;
  const std::size_t pixel = static_cast<std::size_t>(v) * static_cast<std::size_t>(width) + static_cast<std::size_t>(u);
  const auto node = static_cast<std::uint32_t>(pixel_.size());
  pixel_.push_back(static_cast<std::uint32_t>(pixel));
  parent_.push_back(node);
  point_.push_back(surface.rays.point(u, v, depthUmOf(surface.inverse.values[pixel])));
  node_of_[pixel] = static_cast<std::int32_t>(node);
  linkNeighbours(node, u, v, width);
  linkOverHoles(node, u, width, last_in_row);
}

void Components::find(const Surface& surface, const SegmentParams& params) {
  constexpr int kBlock = 16;  // most blocks show bare table: one test for all of it
  const InverseDepth& inverse = surface.inverse;
  clear(inverse.values.size(), inverse.width_px);
  gap_um_ = params.cluster_gap_mm * 1000;
  farthest_link_ = static_cast<std::uint32_t>(params.bridge_px + 1);
  const HeightTest isAbove(surface.distance_m, params);
  for (int v = 0; v < inverse.height_px; ++v) {
    const std::int32_t* values = inverse.row(v);
    const std::int32_t* columns = surface.table.columns.data();
    const std::int32_t row = surface.table.rows[static_cast<std::size_t>(v)];
    std::int32_t last_in_row = -1;
    for (int first = 0; first < inverse.width_px; first += kBlock) {
      const int end = std::min(first + kBlock, inverse.width_px);
      int any = 0;
      for (int u = first; u < end; ++u) any |= values[u] - (columns[u] + row) > isAbove.margin;
      if (!any) continue;
      for (int u = first; u < end; ++u) {
        if (isAbove(values[u], columns[u] + row)) add(surface, u, v, last_in_row);
      }
    }
  }
}

void Components::sort() {
  const std::size_t nodes = pixel_.size();
  part_of_.resize(nodes);
  first_.assign(1, 0);
  // Roots come before their nodes, so one pass numbers and counts; first_[part + 1] holds the count for now.
  for (std::uint32_t i = 0; i < nodes; ++i) {
    const std::uint32_t root = rootOf(i);
    if (root == i) {
      part_of_[i] = static_cast<std::uint32_t>(first_.size() - 1);
      first_.push_back(0);
    } else {
      part_of_[i] = part_of_[root];
    }
    ++first_[part_of_[i] + 1];
  }
  for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
  sorted_pixels_.resize(nodes);
  // Filling moves each start to its end, which is the next part's start: shift back afterwards.
  for (std::size_t i = 0; i < nodes; ++i) sorted_pixels_[first_[part_of_[i]]++] = pixel_[i];
  for (std::size_t i = first_.size() - 1; i > 0; --i) first_[i] = first_[i - 1];
  first_[0] = 0;
}

}  // namespace voxid
