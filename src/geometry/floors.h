// SPDX-License-Identifier: BSD-3-Clause
// The floor of a bowl or a pan may lie too low to be told from the table pixel by pixel, but not as a whole.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "above_table.h"
#include "components.h"
#include "surface.h"
#include "voxid/geometry/segment_params.h"

namespace voxid {

class FloorFinder {
 public:
  void reserve(std::size_t pixels, int width_px, int height_px);

  /// Gives each part the low pixels that it surrounds in the image, if it meets them without a step and they lie above
  /// the table in the mean.
  void addFloors(const Surface& surface, const SegmentParams& params, Components& components);

 private:
  /// Pixels of a row between two runs of a part.
  struct Gap {
    Run run;
    std::uint32_t parent;  ///< another gap of the same hole
    bool open = false;     ///< the hole leads out of the part
  };
  /// A row of a part: its ends, and the gaps in between.
  struct Row {
    int v;
    std::uint32_t begin, end;
    std::size_t first_gap, end_gap;
  };
  /// What the low pixels of a hole say.
  struct Hole {
    std::int64_t height_um = 0;  ///< sum
    int pixels = 0, contacts = 0;

    bool isFloor() const;
  };

  void findGaps(const Surface& surface, Span<const Run> runs);
  void linkRows(const Row& above, const Row& below, std::uint32_t width);
  void open(const Row& row);
  void openBeyond(const Row& row, const Row& other, std::int64_t shift);
  std::uint32_t rootOf(std::uint32_t gap);
  void unite(std::uint32_t a, std::uint32_t b);
  template <typename Visit>
  void visitLow(const Surface& surface, const Run& run, Visit visit) const;
  int contactsOf(const Surface& surface, int u, int v, std::uint32_t pixel) const;
  void measureHoles(const Surface& surface);
  void takeFloors(const Surface& surface);

  AboveTable above_;
  DepthStep step_;
  std::vector<Gap> gaps_;    // of one part
  std::vector<Hole> holes_;  // by root
  std::vector<Run> floors_;
};

}  // namespace voxid
