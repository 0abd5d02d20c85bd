// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/core/grid.h"

#include "bits.h"
#include "vectorised.h"

namespace voxid {
namespace {

constexpr int kSide = VoxelGrid::kSide;
constexpr int kRows = kSide * kSide;
using Rows = std::array<std::uint64_t, kRows>;

// How far apart neighbours along y and z are.
constexpr int kAlongY = 1, kAlongZ = kSide;

VOXID_VECTORISED void dilateX(Rows& rows) {
  for (std::uint64_t& row : rows) row |= row << 1 | row >> 1;
}

// Beyond the border counts as set: erosion must not eat what dilation could not reach.
VOXID_VECTORISED void erodeX(Rows& rows) {
  constexpr std::uint64_t kTop = std::uint64_t{1} << (kSide - 1);
  for (std::uint64_t& row : rows) row &= (row << 1 | 1) & (row >> 1 | kTop);
}

// `out` holds `in` when it is called. Rows of one line along the axis stay among themselves.
VOXID_VECTORISED void dilate(const Rows& in, int stride, Rows& out) {
  for (int line = 0; line < kRows; line += kSide * stride) {
    const int end = line + kSide * stride;
    for (int row = line + stride; row < end; ++row) out[row] |= in[row - stride];
    for (int row = line; row < end - stride; ++row) out[row] |= in[row + stride];
  }
}

VOXID_VECTORISED void erode(const Rows& in, int stride, Rows& out) {
  for (int line = 0; line < kRows; line += kSide * stride) {
    const int end = line + kSide * stride;
    for (int row = line + stride; row < end; ++row) out[row] &= in[row - stride];
    for (int row = line; row < end - stride; ++row) out[row] &= in[row + stride];
  }
}

VOXID_VECTORISED void unite(const Rows& in, Rows& out) {
  for (int row = 0; row < kRows; ++row) out[row] |= in[row];
}

}  // namespace

int VoxelGrid::count() const {
  int cells = 0;
  for (const std::uint64_t row : rows_) cells += bitsSet(row);
  return cells;
}

void VoxelGrid::thicken() {
  const Rows in = rows_;
  dilateX(rows_);
  dilate(in, kAlongY, rows_);
  dilate(in, kAlongZ, rows_);
}

// The 26-neighbourhood is a box, so that one pass an axis gives it.
void VoxelGrid::close() {
  Rows a = rows_, b;
  dilateX(a);
  dilate(b = a, kAlongY, a);
  dilate(b = a, kAlongZ, a);
  erodeX(a);
  erode(b = a, kAlongY, a);
  erode(b = a, kAlongZ, a);
  unite(a, rows_);
}

}  // namespace voxid
