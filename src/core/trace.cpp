// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/core/trace.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <tuple>
#include <utility>

namespace voxid {

// The textbook's error terms: twice the distance to the next change of cell, in parts of a step.
Trace walk(const VoxelGrid& surface, Cell a, Cell b) {
  if (std::tie(b.z, b.y, b.x) < std::tie(a.z, a.y, a.x)) std::swap(a, b);
  std::array<int, 3> at{a.x, a.y, a.z}, length{b.x - a.x, b.y - a.y, b.z - a.z}, sign{}, error{};
  for (int axis = 0; axis < 3; ++axis) {
    sign[axis] = length[axis] < 0 ? -1 : 1;
    length[axis] = std::abs(length[axis]);
  }
  const int steps = std::max({length[0], length[1], length[2]});
  for (int axis = 0; axis < 3; ++axis) error[axis] = 2 * length[axis] - steps;
  Trace line;
  for (int i = 1; i < steps; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      if (error[axis] >= 0) {
        at[axis] += sign[axis];
        error[axis] -= 2 * steps;
      }
      error[axis] += 2 * length[axis];
    }
    const auto cell = [&](int axis) { return static_cast<std::uint8_t>(at[axis]); };
    ++line.inner;
    line.on += surface.test({cell(0), cell(1), cell(2)});
  }
  return line;
}

LineKind kindOf(Trace line) {
  if (5 * line.on >= 4 * line.inner) return LineKind::On;
  return 5 * line.on <= line.inner ? LineKind::Off : LineKind::Mixed;
}

}  // namespace voxid
