// SPDX-License-Identifier: BSD-3-Clause
// doc/descriptor.md gives the definition, the range of every integer here and the reason of every choice.
#include "voxid/core/depth_descriptor.h"

#include <algorithm>
#include <utility>

#include "depth_patch.h"
#include "even_choice.h"
#include "normaliser.h"
#include "pair_group.h"
#include "pair_sampler.h"
#include "point_rows.h"
#include "polar_layout.h"
#include "scales.h"

namespace voxid {
namespace {

static_assert(kDepthHistogramBins + PolarLayout::kNumbers == kDepthBins);

// What cells count in; PairGroup has the histograms before.
enum Histogram { kRadius = 11, kRadiusSlope, kRadiusAlong, kSlope, kSlopeDepth };

std::int32_t cosineOf(const Direction1024& a, const Direction1024& b) {
  return (a.x * b.x + a.y * b.y + a.z * b.z) / 1024;
}

}  // namespace

struct DepthDescriber::Workspace {
  DescriptorParams params;
  DepthPatch patch;
  std::array<Pixel, kMaxPoints> pixels;
  PointRows points;
  std::array<std::uint32_t, kDepthHistogramBins> counts;
  PolarLayout layout;

  DescribeStatus draw(const DepthView& depth, Span<const std::uint32_t> chosen);
  void count(Histogram histogram, int bin) {
    ++counts[kDepthHistograms[histogram].first_bin + static_cast<std::size_t>(bin)];
  }
  void countCells();
  void countCell(const SurfaceCell& cell);
  void countPairs();
  void write(DepthBins& bins) const;
};

DescribeStatus DepthDescriber::Workspace::draw(const DepthView& depth, Span<const std::uint32_t> chosen) {
  if (depth.empty() || !depth.camera.valid()) return DescribeStatus::Empty;
  points.size = 0;
  const BackProjector camera(depth.camera);
  forEachPixel(depth, chosen, [&](const Pixel& pixel) {
    pixels[points.size] = pixel;
    points.add(camera.point(pixel.u, pixel.v, pixel.z_um));
  });
  if (points.size == 0) return DescribeStatus::Empty;
  const Box box = boxOf(points);
  if (isOnePoint(box)) return DescribeStatus::Degenerate;
  const Frame frame(box);
  frame.enter(points);
  const Normaliser normaliser = normaliserOf(points);
  const std::int64_t d_um = std::max<std::int64_t>(frame.lengthUm(static_cast<std::int64_t>(normaliser.d)), 1);
  patch.draw(depth.camera, {pixels.data(), points.size}, frame.pointUm(normaliser.centroid), d_um);
  return patch.cells().size < 2 ? DescribeStatus::Degenerate : DescribeStatus::Ok;
}

void DepthDescriber::Workspace::countCells() {
  for (const SurfaceCell& cell : patch.cells()) countCell(cell);
}

void DepthDescriber::Workspace::countCell(const SurfaceCell& cell) {
  const std::int32_t squared = cell.x * cell.x + cell.y * cell.y + cell.z * cell.z;
  const int part = distanceOf(4 * squared);  // 1/128 of D: the centroid is at most some D / 2 away
  const int ring = part / 8;
  const int slope = std::min(-cell.nz / 16, 63);
  const int along = angleOf(cosineOf({cell.nx, cell.ny, cell.nz}, normalised(cell.x, cell.y, cell.z)));
  const int depth = std::min(std::max((cell.w + 1024) / 256, 0), 7);
  count(kRadius, part / 2);
  count(kRadiusSlope, ring * 8 + slope / 8);
  count(kRadiusAlong, ring * 8 + along / 8);
  count(kSlope, slope / 2);
  count(kSlopeDepth, slope / 8 * 8 + depth);
}

void DepthDescriber::Workspace::countPairs() {
  const Span<const SurfaceCell> cells = patch.cells();
  PairSampler pairs(params.seed, static_cast<std::uint32_t>(cells.size));
  PairGroup group;
  PairGroup::Bins bins;
  std::uint32_t before = pairs.next().first;
  for (std::size_t left = params.pairs; left > 0;) {
    const std::size_t count = std::min(left, PairGroup::kPairs);
    for (std::size_t i = 0; i < count; ++i) {
      const auto [first, second] = pairs.next();
      group.set(i, cells[first], cells[second], cells[std::exchange(before, first)]);
    }
    group.measure(patch, bins);
    for (std::size_t i = 0; i < count; ++i) {  // a pair's bins differ: no count waits for the one before
      for (const PairGroup::Lanes& lanes : bins) ++counts[static_cast<std::size_t>(lanes[i])];
    }
    left -= count;
  }
}

void DepthDescriber::Workspace::write(DepthBins& bins) const {
  for (const SubHistogram& histogram : kDepthHistograms) {
    const std::uint32_t* const first = counts.data() + histogram.first_bin;
    std::uint64_t all = 0;
    for (int i = 0; i < histogram.bins; ++i) all += first[i];
    for (int i = 0; i < histogram.bins; ++i)
      bins[histogram.first_bin + static_cast<std::size_t>(i)] = rootOfShare(first[i], all);
  }
}

DepthDescriber::DepthDescriber(const DescriptorParams& params) : workspace_(std::make_unique<Workspace>()) {
  workspace_->params = params;
  workspace_->params.pairs = std::min(std::max(params.pairs, std::uint32_t{1}), kMaxPairs);
}

DepthDescriber::~DepthDescriber() = default;
DepthDescriber::DepthDescriber(DepthDescriber&&) noexcept = default;
DepthDescriber& DepthDescriber::operator=(DepthDescriber&&) noexcept = default;

DescribeStatus DepthDescriber::describe(const DepthView& depth, Span<const std::uint32_t> pixels, DepthBins& bins) {
  bins.fill(0);
  const DescribeStatus status = workspace_->draw(depth, pixels);
  if (status != DescribeStatus::Ok) return status;
  workspace_->counts.fill(0);
  workspace_->countCells();
  workspace_->countPairs();
  workspace_->write(bins);
  workspace_->layout.measure(workspace_->patch.cells(), &bins[kDepthHistogramBins]);
  return DescribeStatus::Ok;
}

}  // namespace voxid
