// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/core/trace.h"

#include <algorithm>
#include <cstdlib>

namespace voxid {
namespace {

// A position on the line as one word of three 21-bit lanes (z, y, x from the top), each 6 bits of cell and 15 of
// fraction, so that a step is a single addition. Lanes never go negative, so that borrows of negative steps cancel.
constexpr int kFraction = 15;
constexpr int kLane = 21;

// Bresenham rounds a position to the nearest cell, halves in the direction of the step. Along n <= 63 steps no position
// but a half is nearer to a half than 1 / 2n >= 260 / 2^15, and truncating the step costs less than 63 / 2^15 in all:
// a push of 128 / 2^15 towards the step's direction rounds every position as exact arithmetic would.
constexpr std::int64_t kHalf = 1 << (kFraction - 1);
constexpr std::int64_t kPush = 128;

struct Lane {
  std::int64_t start, step;
};

// Positions of one axis from cell `from` to cell `to` in `steps` steps.
Lane laneOf(int from, int to, int steps) {
  const int d = to - from;
  const std::int64_t size = (std::abs(d) << kFraction) / steps;
  const std::int64_t start = (std::int64_t{from} << kFraction) + kHalf;
  return d < 0 ? Lane{start - kPush, -size} : Lane{start + kPush, size};
}

std::int64_t pack(std::int64_t z, std::int64_t y, std::int64_t x) {
  return z * (std::int64_t{1} << 2 * kLane) + y * (std::int64_t{1} << kLane) + x;
}

bool comesFirst(Cell a, Cell b) {
  if (a.z != b.z) return a.z < b.z;
  return a.y != b.y ? a.y < b.y : a.x <= b.x;
}

int chebyshev(Cell a, Cell b) {
  return std::max({std::abs(a.x - b.x), std::abs(a.y - b.y), std::abs(a.z - b.z)});
}

}  // namespace

Trace walk(const VoxelGrid& surface, Cell a, Cell b) {
  if (!comesFirst(a, b)) std::swap(a, b);
  const int steps = chebyshev(a, b);
  if (steps < 2) return {};
  const Lane x = laneOf(a.x, b.x, steps), y = laneOf(a.y, b.y, steps), z = laneOf(a.z, b.z, steps);
  const auto step = static_cast<std::uint64_t>(pack(z.step, y.step, x.step));
  auto at = static_cast<std::uint64_t>(pack(z.start, y.start, x.start));
  const std::uint64_t* rows = surface.rows().data();
  std::uint64_t on = 0;
  for (int i = 1; i < steps; ++i) {
    at += step;
    const std::uint64_t row = (at >> (2 * kLane + kFraction - 6) & 0xfc0) | (at >> (kLane + kFraction) & 63);
    on += rows[row] >> (at >> kFraction & 63) & 1;
  }
  return {static_cast<std::uint8_t>(steps - 1), static_cast<std::uint8_t>(on)};
}

LineKind kindOf(Trace line) {
  if (5 * line.on >= 4 * line.inner) return LineKind::On;
  return 5 * line.on <= line.inner ? LineKind::Off : LineKind::Mixed;
}

}  // namespace voxid
