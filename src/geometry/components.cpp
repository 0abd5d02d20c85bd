// SPDX-License-Identifier: BSD-3-Clause
#include "components.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace voxid {

void Components::reserve(std::size_t pixels, int width_px) {
  node_of_.resize(pixels);
  pixel_.reserve(pixels);
  parent_.reserve(pixels);
  point_.reserve(pixels);
  part_of_.reserve(pixels);
  first_.reserve(pixels + 1);
  sorted_pixels_.reserve(pixels);
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

void Components::linkOverHole(std::uint32_t node, std::uint32_t earlier) {
  if (nearInSpace(node, earlier)) unite(node, earlier);
}

void Components::find(const InverseDepth& inverse, const PlaneSums& sums, double distance_m, const Rays& rays,
                      const SegmentParams& params) {
  const int width = inverse.width_px;
  reserve(inverse.values.size(), width);
  gap_um_ = params.cluster_gap_mm * 1000;
  const std::int32_t margin = params.min_margin_per_km * kUnitsPerKm;
  const std::int64_t distance_um = std::llround(distance_m * 1e6);
  const std::int64_t lowest_um = params.min_height_mm * 1000, highest_um = params.max_height_mm * 1000;
  const auto farthest_column = static_cast<std::uint32_t>(params.bridge_px + 1);

  for (int v = 0; v < inverse.height_px; ++v) {
    const std::int32_t* values = inverse.row(v);
    std::int32_t* nodes = node_of_.data() + static_cast<std::size_t>(v) * width;
    const std::int32_t row = sums.rows[static_cast<std::size_t>(v)];
    std::int32_t last_in_row = -1;
    for (int u = 0; u < width; ++u) {
      nodes[u] = -1;
      const std::int32_t value = values[u];
      const std::int64_t above = value - (sums.columns[static_cast<std::size_t>(u)] + row);
      if (above <= margin || value == 0) continue;
      // Height = distance (1 - expected / inverse): compared without a division.
      const std::int64_t scaled_height = above * distance_um;
      if (scaled_height <= lowest_um * value || scaled_height > highest_um * value) continue;

      const auto node = static_cast<std::uint32_t>(pixel_.size());
      pixel_.push_back(static_cast<std::uint32_t>(static_cast<std::size_t>(v) * width + u));
      parent_.push_back(node);
      point_.push_back(rays.point(u, v, depthUmOf(value)));
      nodes[u] = static_cast<std::int32_t>(node);
      linkNeighbours(node, u, v, width);

      if (last_in_row >= 0) {
        const auto earlier = static_cast<std::uint32_t>(last_in_row);
        const std::uint32_t step = pixel_[node] - pixel_[earlier];
        if (step > 1 && step <= farthest_column) linkOverHole(node, earlier);
      }
      std::int32_t& last_in_column = last_in_column_[static_cast<std::size_t>(u)];
      if (last_in_column >= 0) {
        const auto earlier = static_cast<std::uint32_t>(last_in_column);
        const std::uint32_t step = (pixel_[node] - pixel_[earlier]) / static_cast<std::uint32_t>(width);
        if (step > 1 && step <= farthest_column) linkOverHole(node, earlier);
      }
      last_in_row = last_in_column = static_cast<std::int32_t>(node);
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
