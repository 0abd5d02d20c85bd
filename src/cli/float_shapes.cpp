// SPDX-License-Identifier: BSD-3-Clause
#include "float_shapes.h"

#include <algorithm>
#include <cmath>

#include "../core/pair_sampler.h"

namespace voxid::cli {
namespace {

using Eigen::Vector3d;

constexpr double kNormaliser = 3.4;  // D, in root mean square distances from the centroid

Vector3d vectorOf(const PointUm& p) { return {1.0 * p.x, 1.0 * p.y, 1.0 * p.z}; }

Cell cellOf(const Vector3d& p) {
  const auto along = [](double share) {
    return static_cast<std::uint8_t>(std::clamp(std::floor((share + 0.5) * VoxelGrid::kSide), 0.0, 63.0));
  };
  return {along(p.x()), along(p.y()), along(p.z())};
}

std::vector<PointUm> evenly(Span<const PointUm> points) {
  const std::size_t kept = std::min<std::size_t>(points.size, 65536);
  std::vector<PointUm> some;
  for (std::size_t i = 0; i < kept; ++i) some.push_back(points[i * points.size / kept]);
  return some;
}

int binOf(double share, int bins) { return std::min(static_cast<int>(share * bins), bins - 1); }

/// Adds 1 to a bin of one of the six histograms.
void count(FloatShapes& shapes, int histogram, double share) {
  const SubHistogram& h = kSubHistograms[static_cast<std::size_t>(histogram)];
  ++shapes[static_cast<std::size_t>(h.first_bin + binOf(share, h.bins))];
}

void addPair(const VoxelGrid& surface, const FloatSample& a, const FloatSample& b, FloatShapes& shapes) {
  constexpr int kCoarse = 0, kFineHistogram = 1, kOn = 2, kRatio = 5;
  const double distance = (a.p - b.p).norm();
  const Trace line = walk(surface, a.cell, b.cell);
  const LineKind kind = kindOf(line);
  count(shapes, kCoarse, distance);
  count(shapes, kFineHistogram, distance);
  count(shapes, kOn + static_cast<int>(kind), distance);
  if (kind == LineKind::Mixed) count(shapes, kRatio, 1.0 * line.on / line.inner);
}

}  // namespace

std::vector<FloatSample> samplesOf(Span<const PointUm> all) {
  const std::vector<PointUm> points = evenly(all);
  const auto n = static_cast<double>(points.size());
  Vector3d centroid = Vector3d::Zero();
  for (const PointUm& p : points) centroid += vectorOf(p);
  centroid /= n;
  double squares = 0;
  for (const PointUm& p : points) squares += (vectorOf(p) - centroid).squaredNorm();
  const double d = kNormaliser * std::sqrt(squares / n);
  std::vector<FloatSample> samples;
  for (const PointUm& point : points) {
    const Vector3d p = (vectorOf(point) - centroid) / d;
    samples.push_back({p, cellOf(p)});
  }
  return samples;
}

VoxelGrid surfaceOf(const std::vector<FloatSample>& samples) {
  VoxelGrid surface;
  for (const FloatSample& sample : samples) surface.set(sample.cell);
  surface.thicken();
  surface.close();
  return surface;
}

FloatShapes floatShapesOf(Span<const PointUm> points, const DescriptorParams& params) {
  const std::vector<FloatSample> samples = samplesOf(points);
  const VoxelGrid surface = surfaceOf(samples);
  PairSampler pairs(params.seed, static_cast<std::uint32_t>(samples.size()));
  FloatShapes shapes{};
  for (std::uint32_t i = 0; i < params.pairs; ++i) {
    const auto [first, second] = pairs.next();
    addPair(surface, samples[first], samples[second], shapes);
  }
  const int first_ratio_bin = kSubHistograms.back().first_bin;
  for (int i = 0; i < kDescriptorBytes; ++i) {
    float& bin = shapes[static_cast<std::size_t>(i)];
    bin = (i < first_ratio_bin ? 255.0f : 127.5f) * std::sqrt(bin / static_cast<float>(params.pairs));
  }
  return shapes;
}

}  // namespace voxid::cli
