// SPDX-License-Identifier: BSD-3-Clause
// Parts that are several objects: touching and stacked things meet at concave creases and at small steps in depth.
#pragma once

#include <cstdint>
#include <vector>

#include "components.h"
#include "surface.h"
#include "voxid/geometry/segment_params.h"

namespace voxid {

/// Works on one part at a time inside its pixel box, in cells: squares of two pixels at 640 columns.
class Splitter {
 public:
  Splitter();
  void reserve(int width_px, int height_px);

  /// Makes several parts of each that creases divide into pieces of at least `fewest` pixels.
  void split(const Surface& surface, const Camera& camera, std::size_t fewest, const SegmentParams& params,
             Components& components);

 private:
  static constexpr std::uint8_t kMostPieces = 63;  // of a part, numbered 1 to 63; 0 is none

  struct Cell {
    std::int32_t inverse = 0;  ///< mean over the part's pixels in the cell; 0 = there are none
    std::uint8_t pixels = 0;
    std::uint8_t left = 0, right = 0, up = 0, down = 0;  ///< cells without a step in that direction, at most kArm
    std::uint8_t piece = 0;
    bool crease = false;
  };
  /// Not of unit length; square = 0: unknown. The slopes are inverse depth per cell to the right and down.
  struct Normal {
    float x, y, z, square, slope_u, slope_v;
  };
  struct Border {
    std::uint32_t cells = 0, creased = 0;
  };

  void takeCells(const InverseDepth& inverse, Span<const Run> runs);
  void linkCells();
  void orientCells(const Camera& camera);
  void markCreases(int angle_deg);
  std::uint8_t findPieces(std::size_t fewest);
  std::size_t flood(std::size_t first);
  void growPieces();
  void measureBorders(std::uint8_t count);
  int rejoin(std::uint8_t count, int share_percent);
  std::size_t cutRuns(const InverseDepth& inverse, Span<const Run> runs);
  std::size_t nearestCell(std::size_t cell, std::int32_t inverse) const;
  bool bends(std::size_t a, std::size_t b, float Normal::*slope, float square_cosine) const;
  std::size_t rowOf(std::uint32_t row_px) const {
    return static_cast<std::size_t>((static_cast<int>(row_px) >> shift_) - top_) * columns_;
  }

  int shift_ = 1;           ///< a cell is 2^shift_ pixels wide
  int left_ = 0, top_ = 0;  ///< the grid's first cell, one outside the part's box
  std::size_t columns_ = 0;
  DepthStep step_;
  std::vector<Cell> cells_;
  std::vector<Normal> normals_;
  std::vector<std::uint32_t> queue_;
  std::vector<Border> borders_;
  std::vector<std::uint8_t> joined_;  ///< piece -> piece that it has become part of
  std::vector<Components::Cut> cuts_;
};

}  // namespace voxid
