// SPDX-License-Identifier: BSD-3-Clause
// What a piece of an image lies between.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "inverse_depth.h"
#include "runs.h"

namespace voxid {

/// How often a piece's border faces which other one, along rows and columns, that does not lie a step behind it.
class Enclosure {
 public:
  /// `pieces`: the number of each pixel's piece, 0 = none. `runs` of the piece `own`, ascending.
  Enclosure(const InverseDepth& inverse, const std::uint8_t* pieces, Span<const Run> runs, std::uint8_t own);

  /// The two that are faced most, the first most of all; 0: none.
  const std::array<std::uint8_t, 2>& walls() const { return walls_; }
  int percent() const { return percent_; }  ///< of the border that faces those two

 private:
  std::array<std::uint8_t, 2> walls_{};
  int percent_ = 0;
};

}  // namespace voxid
