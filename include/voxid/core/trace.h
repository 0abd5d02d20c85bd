// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "voxid/core/grid.h"

namespace voxid {

/// What a line between two cells crosses: its inner cells, both ends left out.
struct Trace {
  std::uint8_t inner = 0;  ///< 0 to 62
  std::uint8_t on = 0;     ///< how many of them are set; 0 to inner
};

/// Walks from a to b by the 3D Bresenham algorithm (Sec. IV.A, Fig. 5), counting inner cells. Always walked from the
/// end that comes first in (z, y, x), so that a line and its reverse give the same answer. At most 62 steps.
Trace walk(const VoxelGrid& surface, Cell a, Cell b);

/// Fig. 6: a line lies on the surface, off it, or partly on and partly off.
enum class LineKind : std::uint8_t { On, Off, Mixed };

/// ON if at least 4/5 of the inner cells are set, OFF if at most 1/5, MIXED otherwise; without inner cells ON.
/// (Tolerances measured, doc/descriptor.md: all/none loses two points of accuracy to noise.)
LineKind kindOf(Trace line);

}  // namespace voxid
