// SPDX-License-Identifier: BSD-3-Clause
// Which pixels hang together, beside a twin that looks at every pair of pixels.
#include "components.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <set>
#include <utility>
#include <vector>

namespace voxid {
namespace {

constexpr int kWidth = 150, kHeight = 90;

/// A table far below, and over it random depth: some missing, some table, the rest at a few depths.
struct RandomFrame {
  InverseDepth inverse;
  PlaneSums table;
  Rays rays;
  Plan plan;
  PlanRays plan_rays;
  static constexpr double kDistance_m = 1;

  explicit RandomFrame(unsigned holes_per_256) {
    std::mt19937 random(3);
    inverse.width_px = kWidth;
    inverse.height_px = kHeight;
    inverse.values.resize(kWidth * kHeight);
    for (std::int32_t& value : inverse.values) {
      const unsigned choice = random() % 256;
      const double depth_um = choice < holes_per_256 / 2 ? 1000000
                              : choice % 32 == 0         ? 880000
                                                         : 800000 + random() % 8000;
      value = choice < holes_per_256 && choice % 2 == 0 ? 0 : static_cast<std::int32_t>(kUnitsTimesUm / depth_um);
    }
    table.columns.assign(kWidth, 0);
    table.rows.assign(kHeight, 256000);  // 1 m
    rays.fill(Camera::fromPixels(130, 130, kWidth / 2.0, kHeight / 2.0), kWidth, kHeight);
    plan.set({Eigen::Vector3d(0, 0, -1), kDistance_m});
    plan_rays.fill(rays, plan);
  }
  Surface surface() const { return {inverse, table, rays, plan, plan_rays, kDistance_m}; }
};

/// Pixel by pixel: 8-neighbours at a depth within the gap, and the last pixel before a hole of at most bridge_px.
class Twin {
 public:
  Twin(const Surface& surface, const SegmentParams& params)
      : surface_(surface), params_(params), parents_(kWidth * kHeight) {
    std::iota(parents_.begin(), parents_.end(), 0);
    for (int v = 0; v < kHeight; ++v) {
      for (int u = 0; u < kWidth; ++u) {
        if (isAbove(u, v)) link(u, v);
      }
    }
  }

  std::set<std::vector<std::uint32_t>> parts() {
    std::vector<std::vector<std::uint32_t>> by_root(parents_.size());
    for (std::uint32_t pixel = 0; pixel < parents_.size(); ++pixel) {
      if (isAbove(static_cast<int>(pixel) % kWidth, static_cast<int>(pixel) / kWidth))
        by_root[rootOf(pixel)].push_back(pixel);
    }
    std::set<std::vector<std::uint32_t>> parts(by_root.begin(), by_root.end());
    parts.erase(std::vector<std::uint32_t>{});
    return parts;
  }

 private:
  std::uint32_t rootOf(std::uint32_t pixel) const {
    while (parents_[pixel] != pixel) pixel = parents_[pixel];
    return pixel;
  }
  std::uint32_t at(int u, int v) const { return static_cast<std::uint32_t>(v * kWidth + u); }
  bool isAbove(int u, int v) const {
    if (u < 0 || v < 0 || u >= kWidth) return false;
    const std::int32_t value = surface_.inverse.values[at(u, v)];
    return value > 0 && 1e6 - depthUmOf(value) > params_.min_height_mm * 1000 + 20000;  // nothing lies near the limit
  }
  void unite(std::uint32_t a, std::uint32_t b) { parents_[rootOf(a)] = rootOf(b); }

  void link(int u, int v) {
    const DepthStep gap(params_.cluster_gap_mm);
    for (const auto& [du, dv] : {std::pair(-1, 0), {-1, -1}, {0, -1}, {1, -1}}) {
      if (!isAbove(u + du, v + dv)) continue;
      const std::uint32_t other = at(u + du, v + dv);
      if (gap.within(surface_.inverse.values[at(u, v)], surface_.inverse.values[other])) unite(at(u, v), other);
    }
    for (const auto& [du, dv] : {std::pair(1, 0), {0, 1}}) {
      int k = 1;
      while (k <= params_.bridge_px + 1 && !isAbove(u - k * du, v - k * dv)) ++k;
      if (k > 1 && k <= params_.bridge_px + 1 && isNear(at(u, v), at(u - k * du, v - k * dv)))
        unite(at(u, v), at(u - k * du, v - k * dv));
    }
  }
  bool isNear(std::uint32_t a, std::uint32_t b) const {
    const PointUm p = surface_.point(a), q = surface_.point(b);
    const double x = p.x - q.x, y = p.y - q.y, z = p.z - q.z;
    return std::sqrt(x * x + y * y + z * z) < params_.cluster_gap_mm * 1000.0;
  }

  const Surface& surface_;
  const SegmentParams& params_;
  std::vector<std::uint32_t> parents_;
};

std::set<std::vector<std::uint32_t>> partsOf(const Surface& surface, const SegmentParams& params) {
  Components components;
  components.reserve(kWidth * kHeight, kWidth);
  components.find(surface, params);
  std::set<std::vector<std::uint32_t>> parts;
  for (std::size_t part = 0; part < components.parts(); ++part) {
    std::vector<Run> runs;
    components.collect(part, runs);
    std::vector<std::uint32_t> pixels(kWidth * kHeight);
    pixels.resize(static_cast<std::size_t>(listPixels({runs.data(), runs.size()}, pixels.data()) - pixels.data()));
    EXPECT_EQ(pixels.size(), components.pixelsIn(part));
    parts.insert(pixels);
  }
  return parts;
}

TEST(Components, AreThoseOfPairsOfPixels) {
  SegmentParams params;
  params.min_height_mm = 20;
  for (const unsigned holes_per_256 : {4u, 60u, 160u, 230u}) {
    for (const auto& [bridge_px, gap_mm] : {std::pair(1, 15), {3, 15}, {1, 60}, {3, 60}}) {  // 15 mm are two pixels
      params.bridge_px = bridge_px;
      params.cluster_gap_mm = gap_mm;
      const RandomFrame frame(holes_per_256);
      const Surface surface = frame.surface();
      EXPECT_EQ(partsOf(surface, params), Twin(surface, params).parts())
          << holes_per_256 << " " << bridge_px << " " << gap_mm;
    }
  }
}

}  // namespace
}  // namespace voxid
