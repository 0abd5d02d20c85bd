// SPDX-License-Identifier: BSD-3-Clause
// Sixteen pairs in step count the same bins as a pair at a time, written as doc/descriptor.md defines them.
#include "../../src/core/pair_group.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <random>
#include <set>
#include <vector>

#include "../../src/core/scales.h"
#include "voxid/core/depth_descriptor.h"

namespace voxid {
namespace {

using Vector3 = std::array<std::int64_t, 3>;

std::int64_t dot(const Vector3& a, const Vector3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
std::int64_t cosineOf(const Vector3& a, const Vector3& b) { return dot(a, b) / 1024; }
Vector3 unit(const Vector3& v) {
  const Direction1024 direction =
      normalised(static_cast<std::int32_t>(v[0]), static_cast<std::int32_t>(v[1]), static_cast<std::int32_t>(v[2]));
  return {direction.x, direction.y, direction.z};
}
int angle(std::int64_t cosine) { return angleOf(static_cast<std::int32_t>(cosine)); }

struct Line {
  std::array<int, 4> samples{};  // on, in front, behind, outside
  std::int64_t sag = 0;
};

Line walked(const DepthPatch& patch, const SurfaceCell& a, const SurfaceCell& b) {
  const auto at = [](int from, int to, int k) { return 32 * from + (2 * k + 1) * (to - from); };
  Line line;
  for (int k = 0; k < 16; ++k) {
    const std::int32_t seen = patch.w((at(a.column, b.column, k) + 16) >> 5, (at(a.row, b.row, k) + 16) >> 5);
    const std::int32_t depth = (at(a.w, b.w, k) >> 5) - seen;
    const int part = seen == DepthPatch::kHole ? 3 : depth < -patch.tolerance() ? 1 : depth > patch.tolerance() ? 2 : 0;
    ++line.samples[static_cast<std::size_t>(part)];
    if (seen != DepthPatch::kHole) line.sag += depth;
  }
  const int met = 16 - line.samples[3];
  line.sag = met == 0 ? 0 : line.sag / met;
  return line;
}

int thirds(int samples) { return samples == 0 ? 0 : samples <= 5 ? 1 : samples <= 10 ? 2 : 3; }

int areaPart(long double squared_area) {
  if (squared_area < 16) return 0;
  int high = 0;
  const long double m = std::frexp(squared_area, &high);  // in [1/2, 1)
  const int quarters = 4 * (high - 1) + static_cast<int>((2 * m - 1) * 4);
  return std::min(std::max((quarters - 96) * 2 / 3, 0), 63);
}

std::multiset<int> binsOf(const DepthPatch& patch, const SurfaceCell& a, const SurfaceCell& b, const SurfaceCell& c) {
  const auto first = [](int histogram) { return kDepthHistograms[static_cast<std::size_t>(histogram)].first_bin; };
  const Vector3 to_b{b.x - a.x, b.y - a.y, b.z - a.z}, to_c{c.x - a.x, c.y - a.y, c.z - a.z};
  const Vector3 na{a.nx, a.ny, a.nz}, nb{b.nx, b.ny, b.nz}, direction = unit(to_b);
  const int distance = std::min(63, static_cast<int>(std::sqrt(static_cast<double>(dot(to_b, to_b) >> 12))));
  std::multiset<int> bins{first(0) + distance};

  const Line line = walked(patch, a, b);
  const auto& n = line.samples;
  bins.insert(first(1) + ((thirds(n[1]) * 4 + thirds(n[2])) * 4 + thirds(n[3])) * 4 + distance / 16);
  bins.insert(first(2) + static_cast<int>(std::max_element(n.begin(), n.end()) - n.begin()) * 32 + distance / 2);
  for (int part = 1; part <= 3; ++part) {
    const int share = std::min((n[static_cast<std::size_t>(part)] + 1) / 2, 7);
    bins.insert(first(3) + ((part - 1) * 8 + share) * 4 + distance / 16);
  }
  const int step = static_cast<int>(std::min<std::int64_t>(std::max<std::int64_t>((line.sag + 1024) / 128, 0), 15));
  bins.insert(first(4) + step * 8 + distance / 8);

  const std::int64_t along_a = cosineOf(na, direction), along_b = -cosineOf(nb, direction);
  const int normals = angle(cosineOf(na, nb)) / 4;
  const auto [least, most] = std::minmax({angle(along_a) / 8, angle(along_b) / 8});
  bins.insert(first(5) + normals * 8 + distance / 8);
  bins.insert(first(6) + (most * (most + 1) / 2 + least) * 8 + distance / 8);
  bins.insert(first(7) + ((along_a + along_b > 0) * 8 + std::min(normals, 7)) * 8 + distance / 8);
  bins.insert(first(8) + std::min(static_cast<int>(std::abs(direction[2])) / 128, 7) * 8 + distance / 8);

  bins.insert(first(9) + angle(cosineOf(direction, unit(to_c))));
  const auto cross = [&](std::size_t i, std::size_t j) {
    return static_cast<long double>(to_b[i] * to_c[j] - to_b[j] * to_c[i]);
  };
  const long double x = cross(1, 2), y = cross(2, 0), z = cross(0, 1);
  bins.insert(first(10) + areaPart(x * x + y * y + z * z));
  return bins;
}

std::vector<std::multiset<int>> binsInStep(const PairGroup& group, const DepthPatch& patch) {
  PairGroup::Bins lanes;
  group.measure(patch, lanes);
  std::vector<std::multiset<int>> bins(PairGroup::kPairs);
  for (const PairGroup::Lanes& lane : lanes) {
    for (std::size_t pair = 0; pair < bins.size(); ++pair) bins[pair].insert(lane[pair]);
  }
  return bins;
}

/// A wavy surface of 60 x 60 cells with holes.
void drawWaves(DepthPatch& patch) {
  const Camera camera = Camera::fromPixels(500, 500, 50, 50);
  std::vector<Pixel> pixels;
  for (int v = 0; v < 100; ++v) {
    for (int u = 0; u < 100; ++u) {
      if (u * v % 7 == 0) continue;
      Pixel pixel{};
      pixel.u = u;
      pixel.v = v;
      pixel.z_um = 1000000 + static_cast<int>(30000 * std::sin(u / 9.0) * std::cos(v / 13.0)) + (u > 70 ? 60000 : 0);
      pixels.push_back(pixel);
    }
  }
  patch.draw(camera, {pixels.data(), pixels.size()}, {0, 0, 1000000}, 213333);
}

class PairGroupTest : public ::testing::Test {
 protected:
  PairGroupTest() { drawWaves(patch); }

  int upTo(int most) { return static_cast<int>(random() % static_cast<unsigned>(2 * most + 1)) - most; }
  /// Anything that a cell may hold: also what no surface would show.
  SurfaceCell anyCell(int most) {
    const auto narrow = [](std::int32_t value) { return static_cast<std::int16_t>(value); };
    const Direction1024 normal = normalised(upTo(1000), upTo(1000), -std::abs(upTo(1000)));
    return {narrow(static_cast<int>(random() % 80)),
            narrow(static_cast<int>(random() % 80)),
            narrow(upTo(most)),
            narrow(upTo(most)),
            narrow(upTo(most)),
            narrow(upTo(most)),
            narrow(normal.x),
            narrow(normal.y),
            narrow(normal.z)};
  }
  SurfaceCell cellOfPatch() { return patch.cells()[random() % patch.cells().size]; }

  template <class Cell>
  void compare(const Cell& cell) {
    for (int round = 0; round < 500; ++round) {
      PairGroup group;
      std::vector<std::multiset<int>> expected;
      for (std::size_t pair = 0; pair < PairGroup::kPairs; ++pair) {
        const SurfaceCell a = cell(), b = pair == 3 ? a : cell(), c = pair == 5 ? a : cell();
        group.set(pair, a, b, c);
        expected.push_back(binsOf(patch, a, b, c));
      }
      ASSERT_EQ(binsInStep(group, patch), expected);
    }
  }

  std::mt19937 random{1};
  DepthPatch patch;
};

TEST_F(PairGroupTest, PairsOfASurfaceCountAsOneByOne) {
  ASSERT_GT(patch.cells().size, 2000u);
  compare([this] { return cellOfPatch(); });
}

TEST_F(PairGroupTest, PairsAtTheLimitsCountAsOneByOne) {
  for (const int most : {1, 40, 2048, 8191}) {
    compare([this, most] { return anyCell(most); });
  }
}

TEST_F(PairGroupTest, APairThatIsNotSetStaysInsideTheHistograms) {
  for (const std::multiset<int>& bins : binsInStep(PairGroup(), patch)) {
    EXPECT_GE(*bins.begin(), 0);
    EXPECT_LT(*bins.rbegin(), kDepthBins);
  }
}

}  // namespace
}  // namespace voxid
