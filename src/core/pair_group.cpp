// SPDX-License-Identifier: BSD-3-Clause
#include "pair_group.h"

#include <algorithm>

#include "scales.h"
#include "vectorised.h"
#include "voxid/core/depth_descriptor.h"

namespace voxid {
namespace {

enum Bin {
  kDistance,
  kLineParts,
  kLineKind,
  kInFront,
  kBehind,
  kOutside,
  kSag,
  kNormals,
  kNormalsAndLine,
  kConvexity,
  kLineSlope,
  kAngleOfThree,
  kAreaOfThree
};

constexpr std::int32_t firstOf(int histogram) {
  return static_cast<std::int32_t>(kDepthHistograms[static_cast<std::size_t>(histogram)].first_bin);
}
constexpr std::array<std::int32_t, 13> kFirst{firstOf(0),      firstOf(1), firstOf(2), firstOf(3), firstOf(3) + 32,
                                              firstOf(3) + 64, firstOf(4), firstOf(5), firstOf(6), firstOf(7),
                                              firstOf(8),      firstOf(9), firstOf(10)};

constexpr std::int32_t kSamples = 16;  // of a line

// kInverseRoots in the width that can be gathered.
constexpr std::array<std::int32_t, 1024> makeWideInverseRoots() {
  std::array<std::int32_t, 1024> table{};
  for (std::size_t i = 0; i < table.size(); ++i) table[i] = kInverseRoots[i];
  return table;
}
constexpr auto kWideInverseRoots = makeWideInverseRoots();

// 2^18 / n, rounded up.
constexpr std::array<std::int32_t, kSamples + 1> kReciprocals{0,     262144, 131072, 87382, 65536, 52429,
                                                              43691, 37450,  32768,  29128, 26215, 23832,
                                                              21846, 20165,  18725,  17477, 16384};

// ---- lanes: no branches, so that sixteen go in step ------------------------------------------------------------

inline std::int32_t step(std::int32_t& v, std::int32_t bits) {
  const std::int32_t shift = v >> bits != 0 ? bits : 0;
  v >>= shift;
  return shift;
}
// The largest even number whose power of two is at most v < 2^30; 0 for 0.
inline std::int32_t evenLogarithm(std::int32_t v) {
  const std::int32_t sixteens = step(v, 16), eights = step(v, 8), fours = step(v, 4);
  return sixteens + eights + fours + step(v, 2);
}

// `normalised` of depth_patch.h for components below 2^14.
inline Direction1024 unitOf(std::int32_t x, std::int32_t y, std::int32_t z) {
  const std::int32_t square = x * x + y * y + z * z;  // < 2^30
  const std::int32_t even = evenLogarithm(square);
  const std::uint32_t m_q8 = static_cast<std::uint32_t>(square) << (30 - even) >> 22;
  const std::int32_t inverse = kWideInverseRoots[m_q8], shift = 5 + even / 2;
  return {x * inverse >> shift, y * inverse >> shift, z * inverse >> shift};
}

// None, up to a third, up to two thirds, more of a line's samples.
inline std::int32_t thirdsOf(std::int32_t samples) { return std::min((samples + 4) * 13 >> 6, 3); }

// Trunc(sum / met) within +-1,152, beyond all bins; 0 if nothing was met. The reciprocal is at most 1 too large, which
// adds at most 1,152 met / 2^18 < 1 / met: never enough to reach the next whole number.
inline std::int32_t meanOf(std::int32_t sum, std::int32_t met) {
  constexpr std::int32_t kMost = 1152;
  const std::int32_t size = std::min(sum < 0 ? -sum : sum, kMost * met) * kReciprocals[met] >> 18;
  return sum < 0 ? -size : size;
}

inline std::uint64_t wideSquare(std::int32_t value) { return static_cast<std::uint64_t>(std::int64_t{value} * value); }

// Sixty-four equal steps of the logarithm, from (D / 64)^2 to D^2 for an area whose square is given.
std::int32_t areaPart(std::uint64_t squared_area) {
  if (squared_area < 16) return 0;
  const int high = 63 - __builtin_clzll(squared_area);
  const int quarters = 4 * high + static_cast<int>(squared_area >> (high - 2) & 3);
  return std::min(std::max((quarters - 4 * 24) * 2 / 3, 0), 63);
}

}  // namespace

void PairGroup::set(std::size_t pair, const SurfaceCell& first, const SurfaceCell& second, const SurfaceCell& third) {
  column_[pair] = first.column;
  row_[pair] = first.row;
  w_[pair] = first.w;
  to_column_[pair] = second.column - first.column;
  to_row_[pair] = second.row - first.row;
  to_w_[pair] = second.w - first.w;
  second_.x[pair] = second.x - first.x;
  second_.y[pair] = second.y - first.y;
  second_.z[pair] = second.z - first.z;
  third_.x[pair] = third.x - first.x;
  third_.y[pair] = third.y - first.y;
  third_.z[pair] = third.z - first.z;
  first_normal_.x[pair] = first.nx;
  first_normal_.y[pair] = first.ny;
  first_normal_.z[pair] = first.nz;
  second_normal_.x[pair] = second.nx;
  second_normal_.y[pair] = second.ny;
  second_normal_.z[pair] = second.nz;
}

// Coordinates in 1/32 of their unit; sample k lies at t = (2 k + 1) / 32.
VOXID_VECTORISED void PairGroup::walk(const DepthPatch& patch, LineParts& line) const {
  constexpr std::int32_t kHalf = 16;
  const std::int32_t tolerance = patch.tolerance();
  const std::int32_t* const surface = patch.rows();
  Lanes column, row, w;
  for (std::size_t i = 0; i < kPairs; ++i) {
    column[i] = 32 * column_[i] - to_column_[i];
    row[i] = 32 * row_[i] - to_row_[i];
    w[i] = 32 * w_[i] - to_w_[i];
  }
  Lanes in_front{}, behind{}, outside{}, sag{};
  for (int k = 0; k < kSamples; ++k) {
    for (std::size_t i = 0; i < kPairs; ++i) {
      column[i] += 2 * to_column_[i];
      row[i] += 2 * to_row_[i];
      w[i] += 2 * to_w_[i];
      const std::int32_t seen = surface[((row[i] + kHalf) >> 5) * DepthPatch::kSide + ((column[i] + kHalf) >> 5)];
      const std::int32_t hole = seen == DepthPatch::kHole, depth = ((w[i] >> 5) - seen) & (hole - 1);
      in_front[i] += depth < -tolerance;
      behind[i] += depth > tolerance;
      outside[i] += hole;
      sag[i] += depth;
    }
  }
  line = {in_front, behind, outside, sag};
}

VOXID_VECTORISED void PairGroup::binLine(const LineParts& line, const Lanes& distance, Bins& bins) const {
  Lanes joint, kind, in_front, behind, outside, sag;
  for (std::size_t i = 0; i < kPairs; ++i) {
    const std::int32_t front = line.in_front[i], back = line.behind[i], out = line.outside[i];
    const std::int32_t met = kSamples - out, on = met - front - back, quarter = distance[i] >> 4;
    joint[i] = kFirst[kLineParts] + ((thirdsOf(front) * 4 + thirdsOf(back)) * 4 + thirdsOf(out)) * 4 + quarter;
    const std::int32_t first_two = std::max(on, front), first_three = std::max(first_two, back);
    const std::int32_t most = out > first_three ? 3 : back > first_two ? 2 : front > on ? 1 : 0;
    kind[i] = kFirst[kLineKind] + most * 32 + (distance[i] >> 1);
    in_front[i] = kFirst[kInFront] + std::min((front + 1) >> 1, 7) * 4 + quarter;
    behind[i] = kFirst[kBehind] + std::min((back + 1) >> 1, 7) * 4 + quarter;
    outside[i] = kFirst[kOutside] + std::min((out + 1) >> 1, 7) * 4 + quarter;
    const std::int32_t step = std::min(std::max((meanOf(line.sag[i], met) + 1024) >> 7, 0), 15);
    sag[i] = kFirst[kSag] + step * 8 + (distance[i] >> 3);
  }
  bins[kLineParts] = joint;
  bins[kLineKind] = kind;
  bins[kInFront] = in_front;
  bins[kBehind] = behind;
  bins[kOutside] = outside;
  bins[kSag] = sag;
}

// Which of the two points comes first is chance: nothing here depends on it.
VOXID_VECTORISED void PairGroup::binNormals(const Vectors& direction, const Lanes& distance, Bins& bins) const {
  Lanes normals, line, convexity, slope;
  for (std::size_t i = 0; i < kPairs; ++i) {
    const std::int32_t dx = direction.x[i], dy = direction.y[i], dz = direction.z[i], ring = distance[i] >> 3;
    const std::int32_t ax = first_normal_.x[i], ay = first_normal_.y[i], az = first_normal_.z[i];
    const std::int32_t bx = second_normal_.x[i], by = second_normal_.y[i], bz = second_normal_.z[i];
    const std::int32_t along_a = (ax * dx + ay * dy + az * dz) / 1024,
                       along_b = -((bx * dx + by * dy + bz * dz) / 1024);
    const std::int32_t angle = angleOf((ax * bx + ay * by + az * bz) / 1024) >> 2;
    const std::int32_t part_a = angleOf(along_a) >> 3, part_b = angleOf(along_b) >> 3;
    const std::int32_t least = std::min(part_a, part_b), most = std::max(part_a, part_b);
    const std::int32_t concave = along_a + along_b > 0 ? 8 : 0;  // the normals lean towards each other
    normals[i] = kFirst[kNormals] + angle * 8 + ring;
    line[i] = kFirst[kNormalsAndLine] + ((most * (most + 1) >> 1) + least) * 8 + ring;
    convexity[i] = kFirst[kConvexity] + (concave + std::min(angle, 7)) * 8 + ring;
    slope[i] = kFirst[kLineSlope] + std::min((dz < 0 ? -dz : dz) >> 7, 7) * 8 + ring;
  }
  bins[kNormals] = normals;
  bins[kNormalsAndLine] = line;
  bins[kConvexity] = convexity;
  bins[kLineSlope] = slope;
}

// Components of a cross product of offsets are below 2^29, their squares sum to less than 2^60.
VOXID_VECTORISED void PairGroup::binArea(Lanes& area) const {
  std::array<std::uint64_t, kPairs> squared;
  for (std::size_t i = 0; i < kPairs; ++i) {
    const std::int32_t x = second_.y[i] * third_.z[i] - second_.z[i] * third_.y[i];
    const std::int32_t y = second_.z[i] * third_.x[i] - second_.x[i] * third_.z[i];
    const std::int32_t z = second_.x[i] * third_.y[i] - second_.y[i] * third_.x[i];
    squared[i] = wideSquare(x) + wideSquare(y) + wideSquare(z);
  }
  for (std::size_t i = 0; i < kPairs; ++i) area[i] = kFirst[kAreaOfThree] + areaPart(squared[i]);
}

VOXID_VECTORISED void PairGroup::measure(const DepthPatch& patch, Bins& bins) const {
  Vectors direction;
  Lanes distance, distance_bin, three;
  for (std::size_t i = 0; i < kPairs; ++i) {
    const std::int32_t x = second_.x[i], y = second_.y[i], z = second_.z[i];
    const Direction1024 to_second = unitOf(x, y, z), to_third = unitOf(third_.x[i], third_.y[i], third_.z[i]);
    direction.x[i] = to_second.x;
    direction.y[i] = to_second.y;
    direction.z[i] = to_second.z;
    distance[i] = distanceOf(x * x + y * y + z * z);
    distance_bin[i] = kFirst[kDistance] + distance[i];
    const std::int32_t cosine = to_second.x * to_third.x + to_second.y * to_third.y + to_second.z * to_third.z;
    three[i] = kFirst[kAngleOfThree] + angleOf(cosine / 1024);
  }
  bins[kDistance] = distance_bin;
  bins[kAngleOfThree] = three;
  LineParts line;
  walk(patch, line);
  binLine(line, distance, bins);
  binNormals(direction, distance, bins);
  binArea(bins[kAreaOfThree]);
}

}  // namespace voxid
