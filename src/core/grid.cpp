// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/core/grid.h"

#include "bits.h"

namespace voxid {
namespace {

constexpr int kSide = VoxelGrid::kSide;
constexpr int kRows = kSide * kSide;
using Rows = std::array<std::uint64_t, kRows>;

// The word of a row's neighbour one row before or after along y (stride 1) or z (stride 64); `outside` beyond the grid.
struct Axis {
  int stride;
  bool first(int row) const { return row / stride % kSide == 0; }
  bool last(int row) const { return row / stride % kSide == kSide - 1; }
};
constexpr Axis kAlongY{1}, kAlongZ{kSide};

void dilateX(Rows& rows) {
  for (std::uint64_t& row : rows) row |= row << 1 | row >> 1;
}

// Beyond the border counts as set: erosion must not eat what dilation could not reach.
void erodeX(Rows& rows) {
  constexpr std::uint64_t kTop = std::uint64_t{1} << (kSide - 1);
  for (std::uint64_t& row : rows) row &= (row << 1 | 1) & (row >> 1 | kTop);
}

void dilate(const Rows& in, Axis axis, Rows& out) {
  for (int row = 0; row < kRows; ++row) {
    const std::uint64_t before = axis.first(row) ? 0 : in[row - axis.stride];
    const std::uint64_t after = axis.last(row) ? 0 : in[row + axis.stride];
    out[row] = in[row] | before | after;
  }
}

void erode(const Rows& in, Axis axis, Rows& out) {
  constexpr std::uint64_t kAll = ~std::uint64_t{0};
  for (int row = 0; row < kRows; ++row) {
    const std::uint64_t before = axis.first(row) ? kAll : in[row - axis.stride];
    const std::uint64_t after = axis.last(row) ? kAll : in[row + axis.stride];
    out[row] = in[row] & before & after;
  }
}

}  // namespace

int VoxelGrid::count() const {
  int cells = 0;
  for (const std::uint64_t row : rows_) cells += bitsSet(row);
  return cells;
}

void VoxelGrid::thicken() {
  const Rows in = rows_;
  Rows along_y, along_z;
  dilateX(rows_);
  dilate(in, kAlongY, along_y);
  dilate(in, kAlongZ, along_z);
  for (int row = 0; row < kRows; ++row) rows_[row] |= along_y[row] | along_z[row];
}

// The 26-neighbourhood is a box, so that one pass an axis gives it.
void VoxelGrid::close() {
  Rows a = rows_, b;
  dilateX(a);
  dilate(a, kAlongY, b);
  dilate(b, kAlongZ, a);
  erodeX(a);
  erode(a, kAlongY, b);
  erode(b, kAlongZ, a);
  for (int row = 0; row < kRows; ++row) rows_[row] |= a[row];
}

}  // namespace voxid
