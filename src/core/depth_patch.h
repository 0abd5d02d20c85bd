// SPDX-License-Identifier: BSD-3-Clause
// What a camera saw of an object, as a small image of its surface with normals. doc/descriptor.md gives the ranges.
#pragma once

#include <array>
#include <cstdint>

#include "even_choice.h"
#include "normaliser.h"
#include "voxid/core/depth_view.h"
#include "voxid/core/span.h"

namespace voxid {

/// A cell of the patch that shows the surface. Lengths in D / 4096, D the object's normaliser.
struct SurfaceCell {
  std::int16_t column, row;
  std::int16_t w;           ///< projective depth, see DepthPatch
  std::int16_t x, y, z;     ///< the point, from the centroid along the camera's axes
  std::int16_t nx, ny, nz;  ///< normal towards the camera x 1024; along the viewing axis where no plane can be fitted
};

/// The object's surface about its centroid, seen along the ray to it: kSide x kSide cells of D / 64 at the centroid's
/// distance z0, each with the mean projective depth w = z0 (1 - z0 / z) of the pixels that fall on it. In (x, y, w)
/// straight lines stay straight, and a disparity step of the sensor has the same size everywhere.
class DepthPatch {
 public:
  static constexpr int kSide = 80;
  static constexpr int kCellUnits = 64;
  static constexpr std::int64_t kUnits = 4096;  ///< of D
  static constexpr std::int32_t kHole = INT16_MIN;

  /// `centroid_um` lies in front of the camera; `d_um` is the normaliser, at least 1.
  void draw(const Camera& camera, Span<const Pixel> pixels, Vector centroid_um, std::int64_t d_um);

  Span<const SurfaceCell> cells() const { return {cells_.data(), count_}; }       ///< row by row
  std::int32_t w(int column, int row) const { return w_[row * kSide + column]; }  ///< kHole where nothing was seen
  const std::int32_t* rows() const { return w_.data(); }                          ///< the same, row * kSide + column
  std::int16_t tolerance() const { return tolerance_; }  ///< how far from the surface, in w, is still on it

 private:
  static constexpr int kCells = kSide * kSide;
  static constexpr int kReach = 3;  // of the window that a normal is fitted in
  static constexpr int kPaddedSide = kSide + 2 * kReach;

  // Sums over a window's row: m of cells (0 or 1), j columns from its middle, w depths.
  struct RowSums {
    std::array<std::int32_t, kPaddedSide * kSide> m{}, jm{}, jjm{}, w{}, jw{};
  };
  // Over the windows about one row's cells: n cells, i rows from their middles.
  struct WindowSums {
    std::array<std::int32_t, kSide> n, j, i, jj, ij, ii, w, jw, iw;
  };
  struct Slope {
    std::int32_t column_q10 = 0, row_q10 = 0;
  };

  void splat(const Camera& camera, Span<const Pixel> pixels, Vector centroid_um, std::int64_t d_um);
  void sumRows();
  void sumDown(int row);
  Slope slopeAt(int column) const;
  void collect();
  SurfaceCell cellAt(int column, int row) const;

  std::int32_t scale_ = 1;  // z0 in units
  std::int16_t tolerance_ = 0;
  std::array<std::int32_t, kCells> sum_, hits_;
  std::array<std::int32_t, kCells> w_;  // 32 bits, which AVX2 can gather
  RowSums rows_;
  WindowSums windows_;
  std::array<SurfaceCell, kCells> cells_;
  std::size_t count_ = 0;
};

struct Direction1024 {
  std::int32_t x, y, z;
};

// 2^15 / sqrt(i / 256) for i from 256 to 1023.
constexpr std::array<std::uint16_t, 1024> makeInverseRoots() {
  std::array<std::uint16_t, 1024> table{};
  for (std::uint64_t i = 256; i < table.size(); ++i) {
    table[i] = static_cast<std::uint16_t>(squareRoot((std::uint64_t{1} << 38) / i));
  }
  return table;
}
constexpr auto kInverseRoots = makeInverseRoots();

/// 1024 v / |v|, within a part in 500, for components up to 32,767; zero stays zero.
inline Direction1024 normalised(std::int32_t x, std::int32_t y, std::int32_t z) {
  const std::uint32_t square =
      static_cast<std::uint32_t>(x * x) + static_cast<std::uint32_t>(y * y) + static_cast<std::uint32_t>(z * z);
  if (square == 0) return {0, 0, 0};
  const int even = (31 - __builtin_clz(square)) & ~1;  // square = m 2^even, m in [1, 4)
  const std::uint32_t m_q8 = even >= 8 ? square >> (even - 8) : square << (8 - even);
  const std::int32_t inverse = kInverseRoots[m_q8];
  const int shift = 5 + even / 2;
  return {x * inverse >> shift, y * inverse >> shift, z * inverse >> shift};
}

}  // namespace voxid
