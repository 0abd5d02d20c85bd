// SPDX-License-Identifier: BSD-3-Clause
// The pixels above the table, and which of them hang together.
#pragma once

#include <cstdint>
#include <vector>

#include "surface.h"
#include "voxid/core/span.h"
#include "voxid/geometry/segment_params.h"

namespace voxid {

/// A node is a pixel above the table; nodes are numbered in the order of their pixels. A part is a set of linked nodes.
class Components {
 public:
  void reserve(std::size_t pixels, int width_px);

  /// One scan: takes the pixels above the table and links each to its neighbours before it.
  void find(const Surface& surface, const SegmentParams& params);

  /// Makes one part of two; numbers and pixels of the parts change with the next sort() only.
  void uniteParts(std::size_t a, std::size_t b);

  /// Makes a part of the pixels that share a number, one for each pixel of the part; numbers and pixels of the parts
  /// change with the next sort() only.
  void splitPart(std::size_t part, Span<const std::uint8_t> numbers);

  /// Numbers the parts 0, 1, ... by their first pixel and sorts their pixels.
  void sort();
  std::size_t parts() const { return first_.empty() ? 0 : first_.size() - 1; }
  Span<const std::uint32_t> pixelsOf(std::size_t part) const {
    return {sorted_pixels_.data() + first_[part], first_[part + 1] - first_[part]};
  }

 private:
  void unite(std::uint32_t a, std::uint32_t b);
  std::uint32_t rootOf(std::uint32_t node);
  void clear(std::size_t pixels, int width_px);
  void linkNeighbours(std::uint32_t node, int u, int v, int width_px);
  void add(const Surface& surface, int u, int v, std::int32_t& last_in_row);
  void linkOverHoles(std::uint32_t node, int u, int width_px, std::int32_t& last_in_row);
  void linkIfNear(std::uint32_t node, std::int32_t other);
  bool nearInSpace(std::uint32_t a, std::uint32_t b) const;

  std::int32_t gap_um_ = 0;
  std::uint32_t farthest_link_ = 0;            ///< pixels
  std::vector<std::int32_t> node_of_;          // by pixel; -1 = on or below the table
  std::vector<std::uint32_t> pixel_, parent_;  // by node
  std::vector<PointUm> point_;                 // by node
  std::vector<std::int32_t> last_in_column_;   // node, -1 = none
  std::vector<std::uint32_t> part_of_;         // by node
  std::vector<std::uint32_t> first_, sorted_pixels_;
};

}  // namespace voxid
