// SPDX-License-Identifier: BSD-3-Clause
// Pixels side by side, and what consists of them.
#pragma once

#include <cstdint>
#include <numeric>
#include <vector>

#include "voxid/core/span.h"

namespace voxid {

/// Pixels side by side in a row: the indices (row * width + column) from begin up to, not including, end.
struct Run {
  std::uint32_t begin, end;

  std::uint32_t size() const { return end - begin; }
};

/// What may be an object.
struct Region {
  Span<const Run> runs;      ///< ascending; at least one
  std::uint32_t pixels = 0;  ///< of all runs
  bool truncated = false;    ///< reaches over the table's outline
};

inline void appendPixels(Span<const Run> runs, std::vector<std::uint32_t>& pixels) {
  for (const Run& run : runs) {
    const std::size_t first = pixels.size();
    pixels.resize(first + run.size());
    std::iota(pixels.begin() + static_cast<std::ptrdiff_t>(first), pixels.end(), run.begin);
  }
}

}  // namespace voxid
