// SPDX-License-Identifier: BSD-3-Clause
// Parts that are several objects: touching and stacked things meet at concave creases and at small steps in depth.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "components.h"
#include "surface.h"
#include "voxid/geometry/segment_params.h"

namespace voxid {

template <typename Steps>
void splitParts(Steps&, const Surface&, const Camera&, std::size_t, const SegmentParams&, Components&);

/// Works on one part at a time inside its pixel box, in cells: squares of two pixels at 640 columns.
class Splitter {
 public:
  Splitter();
  void reserve(int width_px, int height_px);

  /// Makes several parts of each that creases divide into pieces of at least `fewest` pixels.
  void split(const Surface& surface, const Camera& camera, std::size_t fewest, const SegmentParams& params,
             Components& components);

  /// Of cells in a row. Not of unit length; square is not a number: unknown. The first two are the slopes of the
  /// inverse depth to the right and down, times the focal lengths.
  struct Normals {
    float *x, *y, *z, *square;

    Normals from(std::ptrdiff_t cell) const { return {x + cell, y + cell, z + cell, square + cell}; }
  };

 private:
  template <typename Steps>
  friend void splitParts(Steps&, const Surface&, const Camera&, std::size_t, const SegmentParams&, Components&);

  static constexpr std::uint8_t kMostPieces = 63;  // of a part, numbered 1 to 63; 0 is none
  static constexpr int kMargin = 3;                // empty rows above and below: as far as slopes look

  struct Border {
    std::uint32_t cells = 0, creased = 0;
  };

  void takeCells(const InverseDepth& inverse, Span<const Run> runs);
  void addRun(const InverseDepth& inverse, Run run);
  void linkCells();
  void orientCells(const Camera& camera);
  void markCreases(int angle_deg);
  std::uint8_t findPieces(std::size_t fewest);
  void findRuns();
  void addRun(Run run, std::size_t& above);
  std::uint32_t rootOf(std::uint32_t run);
  void unite(std::uint32_t a, std::uint32_t b);
  void growPieces();
  void measureBorders(std::uint8_t count);
  int rejoin(std::uint8_t count, int share_percent);
  std::size_t cutRuns(const InverseDepth& inverse, Span<const Run> runs);
  void cutRun(const InverseDepth& inverse, Run run);
  void addCut(Run run, std::uint8_t piece, bool begins);
  std::size_t nearestCell(std::size_t cell, std::int32_t inverse) const;
  Normals normalsFrom(std::size_t cell);
  std::size_t rowOf(std::uint32_t row_px) const {
    return static_cast<std::size_t>((static_cast<int>(row_px) >> shift_) - first_row_) * columns_;
  }
  std::ptrdiff_t stride() const { return static_cast<std::ptrdiff_t>(columns_); }
  std::ptrdiff_t cells() const { return static_cast<std::ptrdiff_t>(end_ - first_); }

  int shift_ = 1;                         ///< a cell is 2^shift_ pixels wide
  int first_column_ = 0, first_row_ = 0;  ///< of the grid, in cells of the image
  std::size_t columns_ = 0;
  std::size_t first_ = 0, end_ = 0;  ///< the cells between the margins
  DepthStep step_;
  // By cell:
  std::vector<std::int32_t> inverse_;                  ///< mean over the part's pixels in it; 0 = there are none
  std::vector<std::uint8_t> pixels_;                   ///< of the part
  std::vector<std::uint8_t> linked_left_, linked_up_;  ///< 1 = no step in depth to that neighbour
  std::vector<std::uint8_t> arms_;                     ///< such links in a row to all sides, at most 3; packed
  std::vector<float> x_, y_, z_, square_;              ///< Normals
  std::vector<std::uint8_t> crease_, piece_, flags_;
  std::vector<std::uint32_t> queue_;
  // By run of cells:
  std::vector<Run> runs_;
  std::vector<std::uint32_t> parents_, pixels_of_run_;
  std::vector<Border> borders_;
  std::vector<std::uint8_t> joined_;                     ///< piece -> piece that it has become part of
  std::array<std::uint8_t, kMostPieces + 1> numbers_{};  ///< piece -> its number among the cuts, 0 = none yet
  std::uint8_t last_ = 1, pieces_cut_ = 0;
  std::vector<Components::Cut> cuts_;
};

}  // namespace voxid
