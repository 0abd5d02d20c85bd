// SPDX-License-Identifier: BSD-3-Clause
#include "rim.h"

#include <algorithm>
#include <cstring>
#include <limits>

namespace voxid {
namespace {

constexpr int kReach_px = 4;              // at 640 columns
constexpr int kMarginShare_percent = 30;  // of min_margin_per_km

}  // namespace

void RimGrower::reserve(std::size_t pixels, int width_px, int height_px) {
  low_.reserve(width_px, height_px);
  free_.reserve(pixels);
  added_.reserve(pixels);
  runs_.reserve(pixels);
}

void RimGrower::freeOthers(const std::vector<Region>& regions, const InverseDepth& inverse) {
  free_.assign(inverse.values.size(), 1);
  for (const Region& region : regions) {
    for (const Run& run : region.runs) std::memset(free_.data() + run.begin, 0, run.size());
  }
}

/// Gives a region a pixel in row v, beside its pixel `from`, if both belong together.
void RimGrower::take(const Surface& surface, Added next, std::uint32_t from, int v) {
  const InverseDepth& inverse = surface.inverse;
  const std::int32_t value = inverse.values[next.pixel];
  const int u = static_cast<int>(next.pixel) - v * inverse.width_px;
  if (!low_.contains(value, u, v) || !gap_.within(inverse.values[from], value)) return;
  free_[next.pixel] = 0;
  added_.push_back(next);
}

/// To the left and right of ascending runs, and above and below.
void RimGrower::growRuns(const Surface& surface, std::uint32_t region, Span<const Run> runs) {
  const auto width = static_cast<std::uint32_t>(surface.inverse.width_px);
  const Run *above = runs.begin(), *below = runs.begin();
  for (const Run& run : runs) {
    const int v = surface.row(run.begin);
    const std::uint32_t row_begin = static_cast<std::uint32_t>(v) * width;
    const auto takeBeside = [&](std::uint32_t from, std::uint32_t next, int next_v) {
      if (free_[next]) take(surface, {region, next}, from, next_v);
    };
    if (run.begin > row_begin) takeBeside(run.begin, run.begin - 1, v);
    if (run.end < row_begin + width) takeBeside(run.end - 1, run.end, v);
    if (v > 0) {
      visitUncovered(run, width, above, runs.end(), [&](std::uint32_t begin, std::uint32_t end) {
        for (std::uint32_t pixel = begin; pixel < end; ++pixel) takeBeside(pixel, pixel - width, v - 1);
      });
    }
    if (v + 1 < surface.inverse.height_px) {
      visitUncovered(run, -static_cast<std::int64_t>(width), below, runs.end(),
                     [&](std::uint32_t begin, std::uint32_t end) {
                       for (std::uint32_t pixel = begin; pixel < end; ++pixel) takeBeside(pixel, pixel + width, v + 1);
                     });
    }
  }
}

/// The same around one pixel.
void RimGrower::growPixel(const Surface& surface, Added added) {
  const int width = surface.inverse.width_px, v = surface.row(added.pixel);
  const int u = static_cast<int>(added.pixel) - v * width;
  const auto takeAt = [&](int du, int dv) {
    const auto next = added.pixel + static_cast<std::uint32_t>(dv * width + du);
    if (free_[next]) take(surface, {added.region, next}, added.pixel, v + dv);
  };
  if (u > 0) takeAt(-1, 0);
  if (u + 1 < width) takeAt(1, 0);
  if (v > 0) takeAt(0, -1);
  if (v + 1 < surface.inverse.height_px) takeAt(0, 1);
}

/// Both lists ascend within a region.
void RimGrower::merge(std::uint32_t width, std::vector<Region>& regions) {
  std::sort(added_.begin(), added_.end());
  runs_.clear();
  auto next = added_.cbegin();
  for (std::uint32_t i = 0; i < regions.size(); ++i) {
    const std::size_t first = runs_.size();
    const auto add = [&](Run run) {
      if (runs_.size() > first && runs_.back().end == run.begin && run.begin % width != 0)
        runs_.back().end = run.end;
      else
        runs_.push_back(run);
    };
    const auto addThoseBefore = [&](std::uint32_t end) {
      for (; next != added_.cend() && next->region == i && next->pixel < end; ++next) {
        add({next->pixel, next->pixel + 1});
        ++regions[i].pixels;
      }
    };
    for (const Run& run : regions[i].runs) {
      addThoseBefore(run.begin);
      add(run);
    }
    addThoseBefore(std::numeric_limits<std::uint32_t>::max());
    regions[i].runs = {runs_.data() + first, runs_.size() - first};
  }
}

void RimGrower::grow(const Surface& surface, const SegmentParams& params, std::vector<Region>& regions) {
  gap_ = DepthStep(params.cluster_gap_mm);
  low_.set(surface.table, surface.distance_m, params.rim_height_mm, params.max_height_mm,
           params.min_margin_per_km * kMarginShare_percent / 100);
  freeOthers(regions, surface.inverse);
  added_.clear();
  for (std::uint32_t i = 0; i < regions.size(); ++i) growRuns(surface, i, regions[i].runs);
  std::size_t first = 0;
  for (int ring = 1; ring < std::max(1, kReach_px * surface.inverse.width_px / 640); ++ring) {
    for (const std::size_t end = added_.size(); first < end; ++first) growPixel(surface, added_[first]);
  }
  merge(static_cast<std::uint32_t>(surface.inverse.width_px), regions);
}

}  // namespace voxid
