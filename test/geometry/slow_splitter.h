// SPDX-License-Identifier: BSD-3-Clause
// The split cell by cell, as it is told in doc/segmentation.md: the twin of the one that takes several cells at a time.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "angle.h"
#include "box.h"
#include "components.h"
#include "split_parts.h"
#include "surface.h"
#include "voxid/geometry/segment_params.h"

namespace voxid::test {

constexpr int kArm = 3;               // cells to either side that a slope is taken over
constexpr int kAcross = 2;            // cells to either side of a crease at which normals are compared
constexpr std::uint8_t kSmall = 255;  // a piece too small to be one
constexpr std::uint8_t kBeingFlooded = 254;

inline std::uint8_t longer(std::uint8_t arm) { return static_cast<std::uint8_t>(std::min(arm + 1, kArm)); }

class SlowSplitter {
 public:
  SlowSplitter(int width_px) : borders_((kMostPieces + 1) * (kMostPieces + 1)), joined_(kMostPieces + 1) {
    for (shift_ = 0; width_px >> (shift_ + 1) >= 320; ++shift_) {
    }
  }

  /// Makes several parts of each that creases divide into pieces of at least `fewest` pixels.
  void split(const Surface& surface, const Camera& camera, std::size_t fewest, const SegmentParams& params,
             Components& components);

 private:
  template <typename Steps>
  friend void voxid::splitParts(Steps&, const Surface&, const Camera&, std::size_t, const SegmentParams&, Components&);

  static constexpr std::uint8_t kMostPieces = 63;  // of a part, numbered 1 to 63; 0 is none

  struct Cell {
    std::int32_t inverse = 0;  ///< mean over the part's pixels in the cell; 0 = there are none
    std::uint16_t pixels = 0;
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

inline void SlowSplitter::takeCells(const InverseDepth& inverse, Span<const Run> runs) {
  const PixelBox box = pixelBoxOf(runs, inverse.width_px);
  left_ = (box.x >> shift_) - 1;
  top_ = (box.y >> shift_) - 1;
  columns_ = static_cast<std::size_t>(((box.x + box.width - 1) >> shift_) - left_ + 2);
  const auto rows = static_cast<std::size_t>(((box.y + box.height - 1) >> shift_) - top_ + 2);
  cells_.assign(columns_ * rows, Cell{});
  const auto width = static_cast<std::uint32_t>(inverse.width_px);
  for (const Run& run : runs) {
    const std::uint32_t row_px = run.begin / width;
    Cell* cells = cells_.data() + rowOf(row_px);
    for (std::uint32_t pixel = run.begin; pixel < run.end; ++pixel) {
      Cell& cell = cells[(static_cast<int>(pixel - row_px * width) >> shift_) - left_];
      cell.inverse += inverse.values[pixel] >> (2 * shift_);
      ++cell.pixels;
    }
  }
  const int all = 1 << (2 * shift_);
  for (Cell& cell : cells_) {
    if (cell.pixels > 0 && cell.pixels != all) cell.inverse = cell.inverse / cell.pixels * all;
  }
}

inline void SlowSplitter::linkCells() {
  for (std::size_t i = columns_; i + columns_ < cells_.size(); ++i) {
    Cell& cell = cells_[i];
    if (step_.within(cells_[i - 1].inverse, cell.inverse)) cell.left = longer(cells_[i - 1].left);
    if (step_.within(cells_[i - columns_].inverse, cell.inverse)) cell.up = longer(cells_[i - columns_].up);
  }
  for (std::size_t i = cells_.size() - columns_; i-- > columns_;) {
    Cell& cell = cells_[i];
    if (cells_[i + 1].left > 0) cell.right = longer(cells_[i + 1].right);
    if (cells_[i + columns_].up > 0) cell.down = longer(cells_[i + columns_].down);
  }
}

/// In inverse depth a plane is affine in the pixel, and its two slopes and its value give its normal.
inline void SlowSplitter::orientCells(const Camera& camera) {
  const float pixel = 1.0f / static_cast<float>(65536 << shift_);
  const float half = 0.5f - 0.5f / static_cast<float>(1 << shift_);  // a cell's middle, in cells
  const float fx = static_cast<float>(camera.fx_q16) * pixel, fy = static_cast<float>(camera.fy_q16) * pixel;
  const float cx = static_cast<float>(camera.cx_q16) * pixel - half,
              cy = static_cast<float>(camera.cy_q16) * pixel - half;
  normals_.resize(cells_.size());
  for (std::size_t row = columns_, v = 1; row + columns_ < cells_.size(); row += columns_, ++v) {
    for (std::size_t u = 1; u + 1 < columns_; ++u) {
      const std::size_t i = row + u;
      const Cell& cell = cells_[i];
      Normal& normal = normals_[i];
      normal.square = 0;
      const int across = cell.left + cell.right, along = cell.up + cell.down;
      if (across < 2 || along < 2) continue;
      normal.slope_u = static_cast<float>(cells_[i + cell.right].inverse - cells_[i - cell.left].inverse) /
                       static_cast<float>(across);
      normal.slope_v =
          static_cast<float>(cells_[i + cell.down * columns_].inverse - cells_[i - cell.up * columns_].inverse) /
          static_cast<float>(along);
      normal.x = normal.slope_u * fx;
      normal.y = normal.slope_v * fy;
      normal.z = static_cast<float>(cell.inverse) -
                 normal.slope_u * (static_cast<float>(left_ + static_cast<int>(u)) - cx) -
                 normal.slope_v * (static_cast<float>(top_ + static_cast<int>(v)) - cy);
      normal.square = normal.x * normal.x + normal.y * normal.y + normal.z * normal.z;
    }
  }
}

/// Whether the surface turns towards the viewer from cell a to cell b by more than the angle.
inline bool SlowSplitter::bends(std::size_t a, std::size_t b, float Normal::*slope, float square_cosine) const {
  const Normal &p = normals_[a], &q = normals_[b];
  if (p.square == 0 || q.square == 0 || q.*slope <= p.*slope) return false;
  const float dot = p.x * q.x + p.y * q.y + p.z * q.z;
  return dot <= 0 || dot * dot < square_cosine * p.square * q.square;
}

inline void SlowSplitter::markCreases(int angle_deg) {
  const auto cosine = static_cast<float>(cosineOf(angle_deg));
  const float square_cosine = cosine * cosine;
  for (std::size_t i = columns_; i + columns_ < cells_.size(); ++i) {
    Cell& cell = cells_[i];
    if (cell.inverse == 0) continue;
    const std::size_t left = std::min<std::size_t>(cell.left, kAcross),
                      right = std::min<std::size_t>(cell.right, kAcross);
    const std::size_t up = std::min<std::size_t>(cell.up, kAcross), down = std::min<std::size_t>(cell.down, kAcross);
    cell.crease =
        (left + right >= kAcross && bends(i - left, i + right, &Normal::slope_u, square_cosine)) ||
        (up + down >= kAcross && bends(i - up * columns_, i + down * columns_, &Normal::slope_v, square_cosine));
  }
}

/// Marks what hangs together with a cell without a step or a crease between; its number of pixels.
inline std::size_t SlowSplitter::flood(std::size_t first) {
  std::size_t pixels = 0;
  queue_.clear();
  const auto visit = [&](std::size_t i) {
    Cell& cell = cells_[i];
    if (cell.piece != 0 || cell.crease) return;
    cell.piece = kBeingFlooded;
    pixels += cell.pixels;
    queue_.push_back(static_cast<std::uint32_t>(i));
  };
  visit(first);
  for (std::size_t k = 0; k < queue_.size(); ++k) {
    const std::size_t i = queue_[k];
    const Cell& cell = cells_[i];
    if (cell.left > 0) visit(i - 1);
    if (cell.right > 0) visit(i + 1);
    if (cell.up > 0) visit(i - columns_);
    if (cell.down > 0) visit(i + columns_);
  }
  return pixels;
}

/// Numbers the pieces by their first cells.
inline std::uint8_t SlowSplitter::findPieces(std::size_t fewest) {
  std::uint8_t count = 0;
  for (std::size_t i = columns_; i + columns_ < cells_.size(); ++i) {
    if (cells_[i].inverse == 0 || cells_[i].piece != 0 || cells_[i].crease) continue;
    const bool enough = flood(i) >= fewest && count < kMostPieces;
    if (enough) ++count;
    for (const std::uint32_t k : queue_) cells_[k].piece = enough ? count : kSmall;
  }
  return count;
}

/// Creases and small pieces go to the pieces around them, cell by cell from all of those at once.
inline void SlowSplitter::growPieces() {
  queue_.clear();
  for (std::size_t i = columns_; i + columns_ < cells_.size(); ++i) {
    if (cells_[i].piece == kSmall) cells_[i].piece = 0;
    if (cells_[i].piece != 0) queue_.push_back(static_cast<std::uint32_t>(i));
  }
  for (std::size_t k = 0; k < queue_.size(); ++k) {
    const std::size_t i = queue_[k];
    for (const std::size_t next : {i - 1, i + 1, i - columns_, i + columns_}) {
      if (cells_[next].inverse == 0 || cells_[next].piece != 0) continue;
      cells_[next].piece = cells_[i].piece;
      queue_.push_back(static_cast<std::uint32_t>(next));
    }
  }
}

inline void SlowSplitter::measureBorders(std::uint8_t count) {
  std::fill(borders_.begin(), borders_.begin() + (count + 1) * (kMostPieces + 1), Border{});
  const auto compare = [&](const Cell& a, const Cell& b, bool step) {
    if (a.piece == b.piece || a.piece == 0 || b.piece == 0) return;
    Border& border = borders_[std::min(a.piece, b.piece) * (kMostPieces + 1u) + std::max(a.piece, b.piece)];
    ++border.cells;
    border.creased += step || a.crease || b.crease;
  };
  for (std::size_t i = columns_; i + columns_ < cells_.size(); ++i) {
    compare(cells_[i], cells_[i + 1], cells_[i].right == 0);
    compare(cells_[i], cells_[i + columns_], cells_[i].down == 0);
  }
}

/// Pieces whose border is hardly a crease are one; how many there are then.
inline int SlowSplitter::rejoin(std::uint8_t count, int share_percent) {
  measureBorders(count);
  for (int i = 0; i <= count; ++i) joined_[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(i);
  int left = count;
  for (std::size_t a = 1; a <= count; ++a) {
    for (std::size_t b = a + 1; b <= count; ++b) {
      const Border& border = borders_[a * (kMostPieces + 1) + b];
      const std::uint8_t low = std::min(joined_[a], joined_[b]), high = std::max(joined_[a], joined_[b]);
      if (low == high || border.creased * 100 >= border.cells * static_cast<std::uint32_t>(share_percent)) continue;
      std::replace(joined_.begin() + 1, joined_.begin() + count + 1, high, low);
      --left;
    }
  }
  return left;
}

/// Of a cell and its neighbours the one whose depth is next to the pixel's: a cell at a step holds pixels of both
/// sides.
inline std::size_t SlowSplitter::nearestCell(std::size_t cell, std::int32_t inverse) const {
  std::size_t nearest = cell;
  for (const std::size_t next : {cell - 1, cell + 1, cell - columns_, cell + columns_}) {
    const bool nearer = std::abs(cells_[next].inverse - inverse) < std::abs(cells_[nearest].inverse - inverse);
    if (cells_[next].piece != 0 && nearer) nearest = next;
  }
  return nearest;
}

/// Cuts the runs where the piece changes; the number of pieces. What no piece has grown to goes with the pixel before.
inline std::size_t SlowSplitter::cutRuns(const InverseDepth& inverse, Span<const Run> runs) {
  std::array<std::uint8_t, kMostPieces + 1> number{};  // from 1, in the order of the first pixels
  std::uint8_t count = 0, last = 1;
  const auto width = static_cast<std::uint32_t>(inverse.width_px);
  cuts_.clear();
  for (const Run& run : runs) {
    const std::uint32_t row_px = run.begin / width;
    const std::size_t cells = rowOf(row_px);
    for (std::uint32_t pixel = run.begin; pixel < run.end; ++pixel) {
      const std::size_t cell =
          cells + static_cast<std::size_t>((static_cast<int>(pixel - row_px * width) >> shift_) - left_);
      const std::int32_t value = inverse.values[pixel];
      const std::size_t own = step_.within(value, cells_[cell].inverse) ? cell : nearestCell(cell, value);
      if (cells_[own].piece != 0) last = joined_[cells_[own].piece];
      if (number[last] == 0) number[last] = ++count;
      const auto piece = static_cast<std::uint8_t>(number[last] - 1);
      if (pixel > run.begin && cuts_.back().piece == piece) {
        ++cuts_.back().run.end;
      } else {
        cuts_.push_back({{pixel, pixel + 1}, piece});
      }
    }
  }
  return count;
}

inline void SlowSplitter::split(const Surface& surface, const Camera& camera, std::size_t fewest,
                                const SegmentParams& params, Components& components) {
  splitParts(*this, surface, camera, fewest, params, components);
}

}  // namespace voxid::test
