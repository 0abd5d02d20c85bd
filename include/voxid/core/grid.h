// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>

namespace voxid {

/// A cell of the 64 x 64 x 64 voxel grid (Sec. IV.A, Fig. 5); each coordinate 0 to 63.
struct Cell {
  std::uint8_t x = 0, y = 0, z = 0;
};

inline bool operator==(Cell a, Cell b) { return a.x == b.x && a.y == b.y && a.z == b.z; }
inline bool operator!=(Cell a, Cell b) { return !(a == b); }

/// The voxel surface: one bit a cell, one 64-bit word a row along x; 32 KiB, so it stays in the L1 cache.
class VoxelGrid {
 public:
  static constexpr int kSide = 64;

  void clear() { rows_.fill(0); }
  void set(Cell c) { rows_[rowOf(c)] |= std::uint64_t{1} << c.x; }
  bool test(Cell c) const { return (rows_[rowOf(c)] >> c.x) & 1; }
  int count() const;

  /// Dilation by one cell along each axis (6 neighbours). Noise and rounding move a point by a cell; a line along the
  /// surface must not miss it by one.
  void thicken();

  /// Closes gaps between the cells of a sampled surface: dilation by one cell (26 neighbours), then erosion by one.
  /// Cells that were set stay set. A far or sparse object covers the grid with gaps of one or two cells; unclosed, ON
  /// would measure the distance to the camera.
  void close();

  const std::array<std::uint64_t, kSide * kSide>& rows() const { return rows_; }

 private:
  static int rowOf(Cell c) { return c.z * kSide + c.y; }
  std::array<std::uint64_t, kSide * kSide> rows_{};
};

}  // namespace voxid
