// SPDX-License-Identifier: BSD-3-Clause
// The lines of a descriptor, walked many at a time: walk() of trace.h defines what each of them counts.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "voxid/core/grid.h"

namespace voxid {

/// The cell as a number that orders by z, then y, then x.
inline std::uint32_t orderOf(Cell c) { return std::uint32_t{c.z} << 16 | std::uint32_t{c.y} << 8 | c.x; }
inline Cell cellOf(std::uint32_t order) {
  return {static_cast<std::uint8_t>(order), static_cast<std::uint8_t>(order >> 8),
          static_cast<std::uint8_t>(order >> 16)};
}

class LineWalker {
 public:
  static constexpr std::size_t kLines = 2048;  ///< a batch

  /// Both ends of each line, to be filled by the caller; orderOf().
  std::array<std::uint32_t, kLines> from, to;

  /// What the lines crossed, as in Trace.
  std::array<std::uint8_t, kLines> inner, on;

  /// The surface that is walked from now on; copied.
  void see(const VoxelGrid& surface);

  /// The first `lines` lines, at most kLines.
  void walk(std::size_t lines);

 private:
  void sortByLength(std::size_t lines);

  std::array<std::uint32_t, 2 * VoxelGrid::kSide * VoxelGrid::kSide> words_;  // rows in halves: x 0 to 31, x 32 to 63
  std::array<std::uint32_t, kLines> first_, last_;                            // the ends in order
  std::array<std::uint16_t, kLines> order_;                                   // lines from short to long
};

}  // namespace voxid
