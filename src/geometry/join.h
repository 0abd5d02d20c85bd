// SPDX-License-Identifier: BSD-3-Clause
// Parts that are one object: cut in two by a nearer object, near and far wall of a vessel, its wall and floor, or what
// was turned on one axis.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "components.h"
#include "plan_shape.h"
#include "surface.h"
#include "voxid/geometry/scene.h"

namespace voxid {

/// What ends a search that begins at a pixel of the piece `own`.
struct SearchEnd {
  int own;
  std::int32_t farthest, nearest;  ///< inverse depths at which another piece faces the pixel
  std::int32_t least;              ///< all between must be nearer than that inverse depth; 0 = whatever lies between
};

class Joiner {
 public:
  Joiner();
  void reserve(std::size_t pixels);

  /// Joins parts of at least `fewest` pixels.
  void join(const Surface& surface, const Camera& camera, std::size_t fewest, Components& components);

 private:
  static constexpr std::size_t kMostPieces = 255;  // numbered 1 to 255; 0 is none

  struct Piece {
    std::size_t part = 0;
    PixelBox box{};
    int top_mm = -1;               ///< -1 = not yet measured
    Eigen::Vector2d middle{0, 0};  ///< 0 = not yet measured
    std::optional<Arcs> arcs;      ///< nothing = not yet looked for
  };
  /// Image lines along which two pieces face each other.
  struct Lines {
    std::uint16_t hidden = 0;    ///< with nothing but missing or nearer depth between them
    std::uint16_t touching = 0;  ///< columns in which the first is right above the second and behind it
  };
  /// A pixel and those to its left (stride 1) or above it (stride of a row) that are looked at.
  struct Line {
    std::size_t pixel, stride;
    int farthest_px;
  };
  struct Faced {
    int piece = 0, steps = 0;  ///< 0 = none
    std::int32_t value = 0;
    std::int32_t between = 0;  ///< least inverse depth between the two
  };

  void takePieces(const Surface& surface, std::size_t fewest, const Components& components);
  template <typename Visit>
  void visitLines(const Surface& surface, const Camera& camera, Span<const Run> runs, Visit visit) const;
  Faced facedBack(const InverseDepth& inverse, const Line& line, const SearchEnd& end) const;
  void countHidden(const InverseDepth& inverse, const Line& line);
  void countTouching(const InverseDepth& inverse, std::size_t pixel);
  Piece& piece(int i) { return pieces_[static_cast<std::size_t>(i)]; }
  Lines& lines(int a, int b) {
    return lines_[static_cast<std::size_t>(a) * (kMostPieces + 1) + static_cast<std::size_t>(b)];
  }
  Lines& linesOf(int a, int b) { return a < b ? lines(a, b) : lines(b, a); }
  int topOf(Piece& piece, const Surface& surface, const Components& components);
  bool topsWithin(int most_mm, int a, int b, const Surface& surface, const Components& components);
  bool cutByNearer(int a, int b, const Surface& surface, const Camera& camera, const Components& components);
  static int lengthInto(const PixelBox& box, const Line& line, int width_px);
  int linesFacing(int from, int to, const Surface& surface, const Camera& camera, const Components& components);
  bool wallsOfVessel(int a, int b, const Surface& surface, const Components& components);
  bool farAndNearWall(const Piece& far, const Piece& near, const Surface& surface, const Components& components);
  bool turnedAsOne(int a, int b, const Surface& surface, const Components& components);
  static const Eigen::Vector2d& middleOf(Piece& piece, const Surface& surface, const Components& components);
  const Arcs& arcsOf(Piece& piece, const Surface& surface, const Components& components);
  void joinToWalls(int floor, const Surface& surface, Components& components);
  void place(const Piece& piece, const Surface& surface, const Components& components, int row_step);

  std::vector<Piece> pieces_;        // the first is no piece
  std::vector<std::uint8_t> piece_;  // by pixel
  std::vector<Lines> lines_;
  std::vector<std::int32_t> heights_um_;  // of one piece's pixels
  PlacedPoints placed_;                   // of one piece
};

}  // namespace voxid
