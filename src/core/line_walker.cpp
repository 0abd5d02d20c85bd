// SPDX-License-Identifier: BSD-3-Clause
#include "line_walker.h"

#include <algorithm>
#include <cstdlib>
#include <numeric>

#include "vectorised.h"

namespace voxid {
namespace {

constexpr std::uint32_t kCell = 63;  // mask of a coordinate
constexpr int kGroup = 16;           // lines in step with each other: a register of AVX-512

// A coordinate is 6 bits of cell over 26 of fraction. Bresenham rounds a position to the nearest cell, halves in the
// direction of the step. Along n <= 63 steps no position but a half is nearer to a half than 1 / 2n >= 2^19 / 2^26, and
// truncating the step costs less than 63^2 / 2^26 in all: a push of 2^14 / 2^26 towards the step's direction rounds
// every position as exact arithmetic would. Lanes never leave 0 to 2^32 on the line.
constexpr int kFraction = 26;
constexpr std::uint32_t kHalf = 1u << (kFraction - 1);
constexpr std::uint32_t kPush = 1u << 14;

// 2^26 / steps of a line with so many inner cells.
constexpr std::array<std::uint32_t, VoxelGrid::kSide> makeReciprocals() {
  std::array<std::uint32_t, VoxelGrid::kSide> reciprocals{};
  for (std::uint32_t inner = 0; inner < reciprocals.size(); ++inner)
    reciprocals[inner] = (1u << kFraction) / (inner + 1);
  return reciprocals;
}
constexpr auto kReciprocals = makeReciprocals();

VOXID_VECTORISED void order(const std::uint32_t* from, const std::uint32_t* to, std::size_t lines, std::uint32_t* first,
                            std::uint32_t* last, std::uint8_t* inner) {
  for (std::size_t i = 0; i < lines; ++i) {
    const std::uint32_t a = std::min(from[i], to[i]), b = std::max(from[i], to[i]);
    const int x = std::abs(static_cast<int>(b & kCell) - static_cast<int>(a & kCell));
    const int y = std::abs(static_cast<int>(b >> 8 & kCell) - static_cast<int>(a >> 8 & kCell));
    const int z = static_cast<int>(b >> 16) - static_cast<int>(a >> 16);
    first[i] = a;
    last[i] = b;
    inner[i] = static_cast<std::uint8_t>(std::max({x, y, z, 1}) - 1);
  }
}

// One coordinate of a group.
struct Lanes {
  std::array<std::uint32_t, kGroup> at, step;

  void start(int lane, std::uint32_t from, std::uint32_t to, std::uint32_t reciprocal) {
    const std::uint32_t d = to - from, sign = d >> 31 ? ~0u : 0u;  // (v ^ sign) - sign gives v the sign of d
    at[lane] = (from << kFraction) + kHalf + (kPush ^ sign) - sign;
    step[lane] = d * reciprocal;
  }
};

struct Group {
  std::array<std::uint32_t, kGroup> first, last, inner, on;
};

// Which way a line goes, how long it is and how it ends are coin tosses to a branch predictor, and a wrong guess costs
// as much as ten steps: hence all of a group walk `steps` steps, and those beyond a line's end do not count.
VOXID_VECTORISED void walkGroup(const std::uint32_t* words, std::uint32_t steps, Group& result) {
  Group group = result;  // a local, which `words` cannot alias
  Lanes x, y, z;
  for (int i = 0; i < kGroup; ++i) {
    const std::uint32_t a = group.first[i], b = group.last[i], reciprocal = kReciprocals[group.inner[i]];
    x.start(i, a & kCell, b & kCell, reciprocal);
    y.start(i, a >> 8 & kCell, b >> 8 & kCell, reciprocal);
    z.start(i, a >> 16, b >> 16, reciprocal);
    group.on[i] = 0;
  }
  for (std::uint32_t walked = 0; walked < steps; ++walked) {
    for (int i = 0; i < kGroup; ++i) {
      x.at[i] += x.step[i];
      y.at[i] += y.step[i];
      z.at[i] += z.step[i];
      const std::uint32_t row = z.at[i] >> kFraction << 6 | y.at[i] >> kFraction;
      const std::uint32_t bit = words[row << 1 | x.at[i] >> 31] >> (x.at[i] >> kFraction & 31) & 1;
      group.on[i] += walked < group.inner[i] ? bit : 0;
    }
  }
  result.on = group.on;
}

}  // namespace

void LineWalker::see(const VoxelGrid& surface) {
  for (std::size_t row = 0; row < surface.rows().size(); ++row) {
    words_[2 * row] = static_cast<std::uint32_t>(surface.rows()[row]);
    words_[2 * row + 1] = static_cast<std::uint32_t>(surface.rows()[row] >> 32);
  }
}

// Counting sort: lines of a group end together.
void LineWalker::sortByLength(std::size_t lines) {
  std::array<std::uint16_t, VoxelGrid::kSide + 1> start{};
  for (std::size_t i = 0; i < lines; ++i) ++start[inner[i] + 1u];
  std::partial_sum(start.begin(), start.end(), start.begin());
  for (std::size_t i = 0; i < lines; ++i) order_[start[inner[i]]++] = static_cast<std::uint16_t>(i);
}

void LineWalker::walk(std::size_t lines) {
  order(from.data(), to.data(), lines, first_.data(), last_.data(), inner.data());
  sortByLength(lines);
  for (std::size_t begin = 0; begin < lines; begin += kGroup) {
    Group group;
    const std::size_t last = lines - 1;
    for (std::size_t i = 0; i < kGroup; ++i) {
      const std::uint16_t line = order_[std::min(begin + i, last)];  // the last group is filled with its last line
      group.first[i] = first_[line];
      group.last[i] = last_[line];
      group.inner[i] = inner[line];
    }
    walkGroup(words_.data(), group.inner[kGroup - 1], group);
    for (std::size_t i = begin; i < std::min(begin + kGroup, lines); ++i) {
      on[order_[i]] = static_cast<std::uint8_t>(group.on[i - begin]);
    }
  }
}

}  // namespace voxid
