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

/// visit(begin, end) for the stretches of a run whose pixels' counterparts, `shift` pixels before them (after them if
/// negative), are in none of the ascending runs from `other` to `others_end`. Moves `other` on to the first that can
/// matter to a later run.
template <typename Visit>
void visitUncovered(Run run, std::int64_t shift, const Run*& other, const Run* others_end, Visit visit) {
  while (other != others_end && other->end + shift <= run.begin) ++other;
  std::int64_t begin = run.begin;
  const auto visitUpTo = [&](std::int64_t end) {
    if (begin < end) visit(static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end));
  };
  for (const Run* next = other; next != others_end && next->begin + shift < run.end; ++next) {
    visitUpTo(next->begin + shift);
    begin = next->end + shift;
  }
  visitUpTo(run.end);
}

/// Lists the pixels of the runs; returns the end of the list.
inline std::uint32_t* listPixels(Span<const Run> runs, std::uint32_t* list) {
  for (const Run& run : runs) {
    std::iota(list, list + run.size(), run.begin);
    list += run.size();
  }
  return list;
}

}  // namespace voxid
