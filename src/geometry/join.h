// SPDX-License-Identifier: BSD-3-Clause
// Parts that are one object: cut in two by a nearer object, or near and far wall of a vessel.
#pragma once

#include <cstdint>
#include <vector>

#include "components.h"
#include "surface.h"

namespace voxid {

class Joiner {
 public:
  Joiner();
  void reserve(std::size_t pixels);

  /// Joins parts of at least `fewest` pixels.
  void join(const Surface& surface, const Camera& camera, std::size_t fewest, Components& components);

 private:
  static constexpr std::size_t kMostPieces = 255;  // numbered 1 to 255; 0 is none
  static constexpr std::size_t kBlockRows = 8;

  struct Piece {
    std::size_t part = 0;
    int top_mm = -1;  ///< -1 = not yet measured
  };
  /// Image lines along which two pieces face each other.
  struct Lines {
    std::uint16_t facing = 0;    ///< all
    std::uint16_t hidden = 0;    ///< with nothing but missing or nearer depth between them
    std::uint16_t touching = 0;  ///< columns in which the first is right above the second and behind it
  };

  void takePieces(const Surface& surface, std::size_t fewest, const Components& components);
  void scan(const Surface& surface, const Camera& camera, Span<const Run> runs);
  void markOccupied(std::size_t width);
  template <typename Visit>
  void visitTop(Run run, int width_px, int step, Visit visit) const;
  template <typename Skipped>
  void faceBack(const InverseDepth& inverse, std::size_t pixel, std::size_t stride, int farthest_px, Skipped skipped);
  void faceLeft(const InverseDepth& inverse, std::size_t pixel, int farthest_px);
  void faceUp(const InverseDepth& inverse, std::size_t pixel, int row, int farthest_px);
  void touch(const InverseDepth& inverse, std::size_t pixel, int row);
  Lines& lines(int a, int b) {
    return lines_[static_cast<std::size_t>(a) * (kMostPieces + 1) + static_cast<std::size_t>(b)];
  }
  int topOf(Piece& piece, const Surface& surface, const Components& components);
  bool cutByNearer(int a, int b, int fewest_lines);
  bool wallsOfVessel(const Piece& far, const Piece& near, const Surface& surface, const Components& components);
  bool belongTogether(int a, int b, const Surface& surface, const Components& components);

  std::vector<Piece> pieces_;           // the first is no piece
  std::vector<std::uint8_t> piece_;     // by pixel
  std::vector<std::uint8_t> occupied_;  // by block of kBlockRows pixels of a column: 0 = they are of no piece
  std::vector<Lines> lines_;
  std::vector<std::int32_t> heights_um_;   // of one piece's pixels
  std::vector<std::uint32_t> heights_mm_;  // two histograms, interleaved
  PlacedPoints placed_;                    // of one piece
};

}  // namespace voxid
