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

/// visit(pixel) for the pixels of a run whose counterparts, `shift` pixels before them (after them if negative), are in
/// none of the ascending runs from `other` to `end`. Moves `other` on to the first that can matter to a later run.
template <typename Visit>
void visitUncovered(Run run, std::int64_t shift, const Run*& other, const Run* end, Visit visit) {
  while (other != end && other->end + shift <= run.begin) ++other;
  std::int64_t pixel = run.begin;
  for (const Run* next = other; next != end && next->begin + shift < run.end; ++next) {
    for (; pixel < next->begin + shift; ++pixel) visit(static_cast<std::uint32_t>(pixel));
    pixel = next->end + shift;
  }
  for (; pixel < run.end; ++pixel) visit(static_cast<std::uint32_t>(pixel));
}

inline void appendPixels(Span<const Run> runs, std::vector<std::uint32_t>& pixels) {
  for (const Run& run : runs) {
    const std::size_t first = pixels.size();
    pixels.resize(first + run.size());
    std::iota(pixels.begin() + static_cast<std::ptrdiff_t>(first), pixels.end(), run.begin);
  }
}

}  // namespace voxid
