// SPDX-License-Identifier: BSD-3-Clause
// The pixels above the table, and which of them hang together.
#pragma once

#include <cstdint>
#include <vector>

#include "above_table.h"
#include "surface.h"
#include "voxid/core/span.h"
#include "voxid/geometry/segment_params.h"

namespace voxid {

/// A part is a list of runs that hang together. Parts can be cut into parts, and parts become groups of parts.
class Components {
 public:
  void reserve(std::size_t pixels, int width_px);

  /// One scan: takes the runs above the table and links each to those before it. Every part is a group of its own.
  void find(const Surface& surface, const SegmentParams& params);

  std::size_t parts() const { return parts_.size(); }
  Span<const Run> runsOf(std::size_t part) const { return {sorted_.data() + parts_[part].first, parts_[part].runs}; }
  std::size_t pixelsIn(std::size_t part) const { return parts_[part].pixels; }

  /// Before any cut. Gives a part more runs, ascending, which no part has.
  void add(std::size_t part, Span<const Run> runs);

  /// A piece of a part: its number, from 0 on, and one of its runs.
  struct Cut {
    Run run;
    std::uint8_t piece;
  };
  /// Before any join. The part becomes its first piece and the others new parts; each piece has a run, `cuts` ascend.
  void cut(std::size_t part, Span<const Cut> cuts, std::size_t pieces);

  void join(std::size_t a, std::size_t b);
  bool firstOfGroup(std::size_t part) const { return parts_[part].group == part; }
  std::uint32_t pixelsInGroup(std::size_t first) const { return parts_[first].group_pixels; }
  /// Appends the runs of a group, ascending.
  void collect(std::size_t first, std::vector<Run>& runs) const;

 private:
  struct Part {
    std::uint32_t first, runs, pixels;
    std::uint32_t group, next;  ///< first part of the group; another part of it, in a circle
    std::uint32_t group_pixels;
  };

  void addRow(const Surface& surface, int v);
  void addRun(const Surface& surface, Run run, int v, std::uint32_t& above);
  void linkAlongRow(const Surface& surface, std::uint32_t run);
  void linkAlongColumns(const Surface& surface, std::uint32_t run, int v, std::uint32_t above);
  void endColumns(std::uint32_t width, int v);
  bool touch(const Surface& surface, Run lower, Run upper) const;
  bool nearInSpace(const Surface& surface, std::uint32_t a, std::uint32_t b) const;
  std::uint32_t rootOf(std::uint32_t run);
  void unite(std::uint32_t a, std::uint32_t b);
  void sortRuns();
  void addPart(std::uint32_t first, std::uint32_t runs, std::uint32_t pixels);

  DepthStep gap_;
  std::int64_t square_gap_um2_ = 0;
  std::uint32_t farthest_link_ = 0;  ///< pixels
  AboveTable above_;
  std::vector<std::uint8_t> states_;           ///< of one row's pixels
  std::vector<Run> runs_;                      ///< in the order of the pixels
  std::vector<std::uint32_t> parents_;         // by run
  std::uint32_t row_above_ = 0, row_ = 0;      ///< first run of the row before, and of this one
  std::vector<std::uint32_t> last_in_column_;  ///< row in which the column was last above the table, before its gap
  std::vector<std::uint32_t> last_run_in_column_;
  std::vector<std::uint32_t> part_of_run_;
  std::vector<Part> parts_;
  std::vector<Run> sorted_;  ///< by part
};

}  // namespace voxid
