// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/core/trace.h"

#include <algorithm>
#include <array>
#include <cstdlib>

#include "bits.h"

namespace voxid {
namespace {

// Which way a line goes, how long it is and how it ends are coin tosses to a branch predictor, and a wrong guess costs
// as much as ten steps: hence arithmetic where one would expect `if`.

// A position on the line as one word of three 21-bit lanes (z, y, x from the top), each 6 bits of cell and 15 of
// fraction, so that a step is a single addition. Lanes never go negative on the line, so borrows of negative steps
// cancel.
constexpr int kFraction = 15;
constexpr int kLane = 21;

// Bresenham rounds a position to the nearest cell, halves in the direction of the step. Along n <= 63 steps no position
// but a half is nearer to a half than 1 / 2n >= 260 / 2^15, and truncating the step costs less than 64 / 2^15 in all:
// a push of 128 / 2^15 towards the step's direction rounds every position as exact arithmetic would.
constexpr std::int32_t kHalf = 1 << (kFraction - 1);
constexpr std::int32_t kPush = 128;

constexpr std::array<std::uint32_t, VoxelGrid::kSide> makeReciprocals() {
  std::array<std::uint32_t, VoxelGrid::kSide> reciprocals{};
  for (std::uint32_t n = 1; n < reciprocals.size(); ++n) reciprocals[n] = 0x80000000u / n;
  return reciprocals;
}
constexpr auto kReciprocals = makeReciprocals();  // 2^31 / n

struct Lane {
  std::int64_t start, step;
};

// Positions of one axis from cell `from` in `steps` steps that go `d` cells in all.
Lane laneOf(std::int32_t from, std::int32_t d, std::int32_t steps) {
  const std::int32_t sign = d >> 31;  // 0 or -1; (v ^ sign) - sign gives v the sign of d
  const auto length = static_cast<std::uint64_t>((d ^ sign) - sign);
  const auto size = static_cast<std::int32_t>(length * kReciprocals[static_cast<std::size_t>(steps)] >> 16);
  return {(from << kFraction) + kHalf + (kPush ^ sign) - sign, (size ^ sign) - sign};
}

std::uint64_t pack(std::int64_t z, std::int64_t y, std::int64_t x) {
  return (static_cast<std::uint64_t>(z) << 2 * kLane) + (static_cast<std::uint64_t>(y) << kLane) +
         static_cast<std::uint64_t>(x);
}

// The multiplication copies y's cell next to z's, whose own copy leaves the word.
std::uint64_t bitAt(const std::uint64_t* rows, std::uint64_t at) {
  constexpr int kRow = 2 * kLane + kFraction - 6;
  constexpr std::uint64_t kCell = 63;
  constexpr std::uint64_t kCells = kCell << (2 * kLane + kFraction) | kCell << (kLane + kFraction);
  const std::uint64_t row = (at & kCells) * ((std::uint64_t{1} << kFraction) + 1) >> kRow;
  return rows[row] >> (at >> kFraction & kCell) & 1;
}

// The cell as a number that orders by z, then y, then x.
std::uint32_t orderOf(Cell c) { return std::uint32_t{c.z} << 16 | std::uint32_t{c.y} << 8 | c.x; }

struct Step {
  std::int32_t x, y, z;
  std::int32_t longest() const { return std::max({std::abs(x), std::abs(y), z}); }
};

}  // namespace

Trace walk(const VoxelGrid& surface, Cell a, Cell b) {
  const std::uint32_t one = orderOf(a), other = orderOf(b);
  const std::uint32_t first = std::min(one, other), last = std::max(one, other);
  const auto x0 = static_cast<std::int32_t>(first & 63), y0 = static_cast<std::int32_t>(first >> 8 & 63),
             z0 = static_cast<std::int32_t>(first >> 16);
  const Step d{static_cast<std::int32_t>(last & 63) - x0, static_cast<std::int32_t>(last >> 8 & 63) - y0,
               static_cast<std::int32_t>(last >> 16) - z0};
  const std::int32_t steps = d.longest();
  const Lane x = laneOf(x0, d.x, steps), y = laneOf(y0, d.y, steps), z = laneOf(z0, d.z, steps);
  const std::uint64_t step = pack(z.step, y.step, x.step);
  std::uint64_t at = pack(z.start, y.start, x.start);
  const std::uint64_t* rows = surface.rows().data();

  // Eight cells at a time, each a bit of `on`; at most 64 in all, those beyond the line's end are shifted out again.
  constexpr int kRun = 8;
  const int inner = std::max(steps, 1) - 1;
  std::uint64_t on = 0;
  int walked = 0;
  for (; walked < inner; walked += kRun) {
    for (int i = 0; i < kRun; ++i) {
      at += step;
      on = on << 1 | bitAt(rows, at);
    }
  }
  on >>= walked - inner;
  return {static_cast<std::uint8_t>(inner), static_cast<std::uint8_t>(bitsSet(on))};
}

LineKind kindOf(Trace line) {
  if (5 * line.on >= 4 * line.inner) return LineKind::On;
  return 5 * line.on <= line.inner ? LineKind::Off : LineKind::Mixed;
}

}  // namespace voxid
