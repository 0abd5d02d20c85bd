// SPDX-License-Identifier: BSD-3-Clause
#include "rim.h"

#include <algorithm>
#include <cstring>

namespace voxid {
namespace {

constexpr int kReach_px = 4;              // at 640 columns
constexpr int kMarginShare_percent = 30;  // of min_margin_per_km

}  // namespace

void RimGrower::reserve(std::size_t pixels, int width_px, int height_px) {
  low_.reserve(width_px, height_px);
  taken_.reserve(pixels);
  added_.reserve(pixels);
  pixels_.reserve(pixels);
}

void RimGrower::takeClusters(const std::vector<Cluster>& clusters, const InverseDepth& inverse) {
  taken_.assign(inverse.values.size(), 0);
  for (const Cluster& cluster : clusters) {
    visitRuns(cluster.pixels, static_cast<std::uint32_t>(inverse.width_px),
              [&](Run run) { std::memset(taken_.data() + run.begin, 1, run.end - run.begin); });
  }
}

/// Whether all four neighbours of `Block` pixels are taken: true for most, and told without their row and column.
template <typename Block>
bool RimGrower::surrounded(std::uint32_t pixel, std::uint32_t width) const {
  if (pixel < width || pixel + sizeof(Block) + width > taken_.size()) return false;
  const std::uint8_t* const here = taken_.data() + pixel;
  const auto at = [](const std::uint8_t* first) {
    Block block;
    std::memcpy(&block, first, sizeof block);
    return block;
  };
  constexpr auto kAllTaken = static_cast<Block>(0x0101010101010101);
  return (at(here - 1) & at(here + 1) & at(here - width) & at(here + width)) == kAllTaken;
}

void RimGrower::visitBorder(const Surface& surface, std::uint32_t cluster, Run run) {
  const auto width = static_cast<std::uint32_t>(surface.inverse.width_px);
  for (std::uint32_t pixel = run.begin; pixel < run.end;) {
    if (pixel + 8 <= run.end && surrounded<std::uint64_t>(pixel, width)) {
      pixel += 8;
      continue;
    }
    if (!surrounded<std::uint8_t>(pixel, width)) visitNeighbours(surface, cluster, pixel);
    ++pixel;
  }
}

void RimGrower::visitNeighbours(const Surface& surface, std::uint32_t cluster, std::uint32_t pixel) {
  const InverseDepth& inverse = surface.inverse;
  const int width = inverse.width_px, v = surface.row(pixel), u = static_cast<int>(pixel) - v * width;
  const std::int32_t here = inverse.values[pixel];
  const auto visit = [&](std::uint32_t next, int next_u, int next_v) {
    const std::int32_t value = inverse.values[next];
    if (taken_[next] || !low_.contains(value, next_u, next_v) || !gap_.within(here, value)) return;
    taken_[next] = 1;
    added_.push_back({cluster, next});
  };
  if (u > 0) visit(pixel - 1, u - 1, v);
  if (u + 1 < width) visit(pixel + 1, u + 1, v);
  if (v > 0) visit(pixel - static_cast<std::uint32_t>(width), u, v - 1);
  if (v + 1 < inverse.height_px) visit(pixel + static_cast<std::uint32_t>(width), u, v + 1);
}

/// Both lists ascend within a cluster.
void RimGrower::merge(std::vector<Cluster>& clusters) {
  std::sort(added_.begin(), added_.end(), [](const Added& a, const Added& b) {
    return a.cluster != b.cluster ? a.cluster < b.cluster : a.pixel < b.pixel;
  });
  pixels_.clear();
  auto next = added_.cbegin();
  for (std::size_t i = 0; i < clusters.size(); ++i) {
    const std::size_t first = pixels_.size();
    const std::uint32_t* from = clusters[i].pixels.begin();
    const std::uint32_t* const end = clusters[i].pixels.end();
    for (; next != added_.cend() && next->cluster == i; ++next) {
      const std::uint32_t* const to = std::lower_bound(from, end, next->pixel);
      pixels_.insert(pixels_.end(), from, to);
      pixels_.push_back(next->pixel);
      from = to;
    }
    pixels_.insert(pixels_.end(), from, end);
    clusters[i].pixels = {pixels_.data() + first, pixels_.size() - first};
  }
}

void RimGrower::grow(const Surface& surface, const SegmentParams& params, std::vector<Cluster>& clusters) {
  gap_ = DepthStep(params.cluster_gap_mm);
  low_.set(surface.table, surface.distance_m, params.rim_height_mm, params.max_height_mm,
           params.min_margin_per_km * kMarginShare_percent / 100);
  takeClusters(clusters, surface.inverse);
  added_.clear();
  for (std::uint32_t i = 0; i < clusters.size(); ++i) {
    visitRuns(clusters[i].pixels, static_cast<std::uint32_t>(surface.inverse.width_px),
              [&](Run run) { visitBorder(surface, i, run); });
  }
  std::size_t first = 0;
  for (int ring = 1; ring < std::max(1, kReach_px * surface.inverse.width_px / 640); ++ring) {
    const std::size_t end = added_.size();
    for (; first < end; ++first) visitNeighbours(surface, added_[first].cluster, added_[first].pixel);
  }
  merge(clusters);
}

}  // namespace voxid
