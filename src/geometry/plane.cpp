// SPDX-License-Identifier: BSD-3-Clause
#include "plane.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "../core/vectorised.h"
#include "angle.h"

namespace voxid {
namespace {

constexpr double kMissProbability = 1e-4;  // RANSAC stops at a confidence of 0.9999
constexpr int kSampleSites = 2133;         // every 12th pixel both ways at 640 x 480
constexpr int kCoarseRowStep = 4;          // of the first refit; the second takes every row
constexpr double kFarthestTable_m = 100;   // micrometres stay below 2^31

std::int32_t saturate(double x) { return static_cast<std::int32_t>(std::floor(std::clamp(x, -5e8, 5e8) + 0.5)); }

int sampleStep(int width_px, int height_px) {
  const double pixels_per_site = static_cast<double>(width_px) * height_px / kSampleSites;
  return std::max(1, static_cast<int>(std::sqrt(pixels_per_site) + 0.5));
}

/// Draws needed so that all of them miss the table with kMissProbability at most.
int drawsFor(int inliers, std::size_t samples, int most) {
  const double share = static_cast<double>(inliers) / static_cast<double>(samples);
  const double miss = 1 - share * share * share;
  int draws = 0;
  for (double all_miss = 1; all_miss > kMissProbability && draws < most; all_miss *= miss) ++draws;
  return draws;
}

/// Sums for a least-squares plane through the residuals of the inliers; integers, so their order does not matter.
struct ResidualSums {
  std::int64_t n = 0, u = 0, v = 0, uu = 0, uv = 0, vv = 0, r = 0, ur = 0, vr = 0;
};

constexpr int kBlock = 256;  // pixels whose sums stay below 2^31 at the largest tolerance, 25,600

struct BlockSums {
  std::int32_t n = 0, k = 0, kk = 0, r = 0, kr = 0;
};

VOXID_VECTORISED BlockSums sumBlock(const std::int32_t* inverse, const std::int32_t* columns, std::int32_t row,
                                    std::int32_t tolerance, int count) {
  BlockSums s;
  for (std::int32_t k = 0; k < count; ++k) {
    const std::int32_t r = inverse[k] - (columns[k] + row);
    const std::int32_t inlier = -static_cast<std::int32_t>((r <= tolerance) & (r >= -tolerance) & (inverse[k] > 0));
    s.n -= inlier;
    s.k += k & inlier;
    s.kk += (k * k) & inlier;
    s.r += r & inlier;
    s.kr += (k * (r & inlier));
  }
  return s;
}

/// Columns are counted from the image's middle to keep the sums small.
void addBlock(const BlockSums& block, std::int64_t first_u, std::int64_t v, ResidualSums& sums) {
  const std::int64_t u = first_u * block.n + block.k;
  const std::int64_t ur = first_u * block.r + block.kr;
  sums.n += block.n;
  sums.u += u;
  sums.uu += first_u * first_u * block.n + 2 * first_u * block.k + block.kk;
  sums.v += v * block.n;
  sums.uv += v * u;
  sums.vv += v * v * block.n;
  sums.r += block.r;
  sums.ur += ur;
  sums.vr += v * block.r;
}

ResidualSums sumInliers(const InverseDepth& inverse, const PlaneSums& plane, std::int32_t tolerance, int row_step) {
  ResidualSums sums;
  const int middle_u = inverse.width_px / 2, middle_v = inverse.height_px / 2;
  for (int v = 0; v < inverse.height_px; v += row_step) {
    for (int u = 0; u < inverse.width_px; u += kBlock) {
      const int count = std::min(kBlock, inverse.width_px - u);
      const BlockSums block = sumBlock(inverse.row(v) + u, plane.columns.data() + u,
                                       plane.rows[static_cast<std::size_t>(v)], tolerance, count);
      if (block.n > 0) addBlock(block, u - middle_u, v - middle_v, sums);
    }
  }
  return sums;
}

VOXID_VECTORISED std::uint32_t countInRow(const std::int32_t* inverse, const std::int32_t* columns, std::int32_t row,
                                          std::int32_t tolerance, int count) {
  std::int32_t inliers = 0;
  for (int u = 0; u < count; ++u) {
    const std::int32_t r = inverse[u] - (columns[u] + row);
    inliers += (r <= tolerance) & (r >= -tolerance) & (inverse[u] > 0);
  }
  return static_cast<std::uint32_t>(inliers);
}

std::uint32_t countInliers(const InverseDepth& inverse, const PlaneSums& plane, std::int32_t tolerance) {
  std::uint32_t inliers = 0;
  for (int v = 0; v < inverse.height_px; ++v) {
    inliers += countInRow(inverse.row(v), plane.columns.data(), plane.rows[static_cast<std::size_t>(v)], tolerance,
                          inverse.width_px);
  }
  return inliers;
}

/// Squares of the heights of a row's inliers, summed in whole square micrometres.
struct SquareSum {
  std::int64_t squares_um2 = 0;
  std::int32_t heights = 0;
};

VOXID_VECTORISED SquareSum squaresInRow(const std::int32_t* inverse, const std::int32_t* columns, std::int32_t row,
                                        std::int32_t tolerance, float distance_um, int count) {
  SquareSum sum;
  for (int u = 0; u < count; ++u) {
    const std::int32_t r = inverse[u] - (columns[u] + row);
    const bool inlier = (r <= tolerance) & (r >= -tolerance) & (inverse[u] > 0);
    const float height_um = distance_um * static_cast<float>(r) / static_cast<float>(inlier ? inverse[u] : 1);
    const std::int64_t whole_um = inlier ? static_cast<std::int32_t>(height_um) : 0;
    sum.squares_um2 += whole_um * whole_um;
    sum.heights += inlier;
  }
  return sum;
}

/// Samples within the limit of the plane normal . (u, v, inverse) = offset.
VOXID_VECTORISED int countNear(const float* u, const float* v, const float* inverse, int count,
                               const Eigen::Vector3d& normal, double offset, double limit) {
  const double nu = normal.x(), nv = normal.y(), nw = normal.z();
  int near = 0;
  for (int i = 0; i < count; ++i) near += std::abs(nu * u[i] + nv * v[i] + nw * inverse[i] - offset) <= limit;
  return near;
}

/// The same in single precision, of the plane inverse = per_u * u + per_v * v + at_origin.
VOXID_VECTORISED int countRoughly(const float* u, const float* v, const float* inverse, int count, float per_u,
                                  float per_v, float at_origin, float limit) {
  int near = 0;
  for (int i = 0; i < count; ++i) near += std::abs(inverse[i] - (per_u * u[i] + per_v * v[i] + at_origin)) <= limit;
  return near;
}

/// The plane that is added to the present one; false if the inliers lie on a line.
bool solve(const ResidualSums& s, InversePlane& change) {
  if (s.n < 3) return false;
  const double n = static_cast<double>(s.n);
  const double mean_u = static_cast<double>(s.u) / n, mean_v = static_cast<double>(s.v) / n;
  const double mean_r = static_cast<double>(s.r) / n;
  const double uu = static_cast<double>(s.uu) / n - mean_u * mean_u;
  const double uv = static_cast<double>(s.uv) / n - mean_u * mean_v;
  const double vv = static_cast<double>(s.vv) / n - mean_v * mean_v;
  const double ur = static_cast<double>(s.ur) / n - mean_u * mean_r;
  const double vr = static_cast<double>(s.vr) / n - mean_v * mean_r;
  const double determinant = uu * vv - uv * uv;
  if (determinant < 1e-6 * (uu * vv + 1)) return false;
  change.per_u = (ur * vv - vr * uv) / determinant;
  change.per_v = (vr * uu - ur * uv) / determinant;
  change.at_origin = mean_r - change.per_u * mean_u - change.per_v * mean_v;
  return true;
}

void refit(const InverseDepth& inverse, std::int32_t tolerance, int row_step, InversePlane& plane, PlaneSums& sums) {
  InversePlane change;
  if (!solve(sumInliers(inverse, sums, tolerance, row_step), change)) return;
  plane.per_u += change.per_u;
  plane.per_v += change.per_v;
  plane.at_origin += change.at_origin - change.per_u * (inverse.width_px / 2) - change.per_v * (inverse.height_px / 2);
  sums.fill(plane, inverse.width_px, inverse.height_px);
}

}  // namespace

MetricPlane metricOf(const InversePlane& plane, const Camera& camera) {
  constexpr double kPixel = 1.0 / 65536, kPerMetre = 1e-3 / kUnitsPerKm;
  const double at_axis = plane.per_u * camera.cx_q16 * kPixel + plane.per_v * camera.cy_q16 * kPixel + plane.at_origin;
  const Eigen::Vector3d scaled(plane.per_u * camera.fx_q16 * kPixel * kPerMetre,
                               plane.per_v * camera.fy_q16 * kPixel * kPerMetre, at_axis * kPerMetre);
  const double length = std::sqrt(scaled.x() * scaled.x() + scaled.y() * scaled.y() + scaled.z() * scaled.z());
  MetricPlane metric;
  if (length < 1e-9) return metric;  // through no finite point
  metric.normal = Eigen::Vector3d(-scaled.x() / length, -scaled.y() / length, -scaled.z() / length);
  metric.distance_m = 1 / length;
  return metric;
}

void PlaneSums::reserve(int width_px, int height_px) {
  columns.reserve(static_cast<std::size_t>(width_px));
  rows.reserve(static_cast<std::size_t>(height_px));
}

void PlaneSums::fill(const InversePlane& plane, int width_px, int height_px) {
  columns.resize(static_cast<std::size_t>(width_px));
  rows.resize(static_cast<std::size_t>(height_px));
  for (int u = 0; u < width_px; ++u) columns[static_cast<std::size_t>(u)] = saturate(plane.per_u * u);
  for (int v = 0; v < height_px; ++v) {
    rows[static_cast<std::size_t>(v)] = saturate(plane.per_v * v + plane.at_origin);
  }
}

/// Three different samples at a time, always the same ones (splitmix64 with a fixed seed).
class PlaneFinder::Draws {
 public:
  explicit Draws(std::size_t samples) : samples_(static_cast<std::uint32_t>(samples)) {}

  void next(std::uint32_t& a, std::uint32_t& b, std::uint32_t& c) {
    a = below(samples_);
    b = below(samples_ - 1);
    if (b >= a) ++b;
    c = below(samples_ - 2);
    const std::uint32_t low = std::min(a, b), high = std::max(a, b);
    if (c >= low) ++c;
    if (c >= high) ++c;
  }

 private:
  std::uint32_t below(std::uint32_t bound) {
    state_ += 0x9e3779b97f4a7c15u;
    std::uint64_t x = state_;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    x ^= x >> 31;
    return static_cast<std::uint32_t>(((x >> 32) * bound) >> 32);
  }

  std::uint32_t samples_;
  std::uint64_t state_ = 20110101;
};

void PlaneFinder::reserve(int width_px, int height_px) {
  const auto step = static_cast<std::size_t>(sampleStep(width_px, height_px));
  const std::size_t most =
      (static_cast<std::size_t>(width_px) / step + 1) * (static_cast<std::size_t>(height_px) / step + 1);
  // A smaller image may have more samples, as steps are whole pixels.
  samples_.reserve(std::max<std::size_t>(most, 3 * kSampleSites));
  above_.reserve(samples_.u.capacity());
}

void PlaneFinder::Samples::reserve(std::size_t most) {
  for (auto* values : {&u, &v, &inverse}) values->reserve(most);
}

void PlaneFinder::Samples::clear() {
  for (auto* values : {&u, &v, &inverse}) values->clear();
}

void PlaneFinder::Samples::add(std::int32_t at_u, std::int32_t at_v, std::int32_t value) {
  u.push_back(static_cast<float>(at_u));
  v.push_back(static_cast<float>(at_v));
  inverse.push_back(static_cast<float>(value));
}

void PlaneFinder::takeSamples(const InverseDepth& inverse) {
  const int step = sampleStep(inverse.width_px, inverse.height_px);
  samples_.clear();
  for (int v = step / 2; v < inverse.height_px; v += step) {
    for (int u = step / 2; u < inverse.width_px; u += step) {
      const std::int32_t value = inverse.row(v)[u];
      if (value > 0) samples_.add(u, v, value);
    }
  }
}

int PlaneFinder::mostInliers(const Samples& samples, const InversePlane& plane, double tolerance) {
  constexpr double kRounding = 1.0 / (1 << 21), kMostColumns = 8192, kLargestInverse = 1 << 24;
  const double largest = (std::abs(plane.per_u) + std::abs(plane.per_v)) * kMostColumns + std::abs(plane.at_origin);
  return countRoughly(samples.u.data(), samples.v.data(), samples.inverse.data(), static_cast<int>(samples.size()),
                      static_cast<float>(plane.per_u), static_cast<float>(plane.per_v),
                      static_cast<float>(plane.at_origin),
                      static_cast<float>(tolerance + kRounding * (largest + kLargestInverse)));
}

int PlaneFinder::countInliers(const Samples& samples, const Eigen::Vector3d& normal, double offset, double limit,
                              int most) {
  constexpr int kChunk = 256;
  const auto size = static_cast<int>(samples.size());
  int inliers = 0;
  for (int first = 0; first < size && inliers + size - first > most; first += kChunk) {
    inliers += countNear(samples.u.data() + first, samples.v.data() + first, samples.inverse.data() + first,
                         std::min(kChunk, size - first), normal, offset, limit);
  }
  return inliers;
}

template <typename Accept>
PlaneFinder::Candidate PlaneFinder::draw(const Samples& samples, const SegmentParams& params, Accept accept) const {
  Candidate best;
  if (samples.size() < 3) return best;
  const double tolerance = params.plane_inlier_per_km * kUnitsPerKm;
  Draws draws(samples.size());
  int needed = params.plane_draws;
  for (int i = 0; i < needed; ++i) {
    std::uint32_t ia, ib, ic;
    draws.next(ia, ib, ic);
    const auto at = [&](std::uint32_t k) { return std::array{samples.u[k], samples.v[k], samples.inverse[k]}; };
    const auto a = at(ia), b = at(ib), c = at(ic);
    // The normal of the plane through three points of (u, v, inverse depth): whole numbers, exact in double.
    const double bu = b[0] - a[0], bv = b[1] - a[1], bw = b[2] - a[2], cu = c[0] - a[0], cv = c[1] - a[1],
                 cw = c[2] - a[2];
    const Eigen::Vector3d n(bv * cw - bw * cv, bw * cu - bu * cw, bu * cv - bv * cu);
    if (n.z() == 0) continue;
    InversePlane plane;
    plane.per_u = -n.x() / n.z();
    plane.per_v = -n.y() / n.z();
    plane.at_origin = a[2] - plane.per_u * a[0] - plane.per_v * a[1];
    if (!accept(plane) || mostInliers(samples, plane, tolerance) <= best.inliers) continue;
    const double offset = n.x() * a[0] + n.y() * a[1] + n.z() * a[2];
    const int inliers = countInliers(samples, n, offset, tolerance * std::abs(n.z()), best.inliers);
    if (inliers <= best.inliers) continue;
    best = {plane, inliers};
    needed = std::min(needed, std::max(i + 1, drawsFor(inliers, samples.size(), params.plane_draws)));
  }
  return best;
}

/// A robot sees more floor than table where the table is small: a parallel plane nearer to the camera that holds 15 %
/// of the samples is the table.
PlaneFinder::Candidate PlaneFinder::tableAboveFloor(Candidate floor, const Camera& camera,
                                                    const SegmentParams& params) {
  constexpr double kTableAboveFloor_m = 0.3;
  constexpr int kMostLevels = 3;
  const double parallel = cosineOf(8);
  const auto enough = static_cast<double>(samples_.size()) * 0.15;
  for (int level = 0; level < kMostLevels; ++level) {
    const MetricPlane below = metricOf(floor.plane, camera);
    above_.clear();
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      const auto u = static_cast<std::int32_t>(samples_.u[i]), v = static_cast<std::int32_t>(samples_.v[i]),
                 value = static_cast<std::int32_t>(samples_.inverse[i]);
      const double expected = floor.plane.per_u * u + floor.plane.per_v * v + floor.plane.at_origin;
      if (below.distance_m * (value - expected) > kTableAboveFloor_m * value) above_.add(u, v, value);
    }
    if (static_cast<double>(above_.size()) < enough) break;
    const Candidate nearer = draw(above_, params, [&](const InversePlane& plane) {
      return metricOf(plane, camera).normal.dot(below.normal) > parallel;
    });
    if (nearer.inliers < enough) break;
    floor = nearer;
  }
  return floor;
}

bool PlaneFinder::find(const InverseDepth& inverse, const Camera& camera, const SegmentParams& params,
                       const Upward& upward, InversePlane& plane, PlaneSums& sums) {
  takeSamples(inverse);
  const double least_up = cosineOf(upward.max_tilt_deg);
  const Candidate largest = draw(samples_, params, [&](const InversePlane& candidate) {
    return metricOf(candidate, camera).normal.dot(upward.direction) >= least_up;
  });
  if (largest.inliers < 3) return false;
  plane = tableAboveFloor(largest, camera, params).plane;
  sums.fill(plane, inverse.width_px, inverse.height_px);
  refit(inverse, params.plane_inlier_per_km * kUnitsPerKm, kCoarseRowStep, plane, sums);
  refit(inverse, fineTolerance(params), 1, plane, sums);
  const double distance_m = metricOf(plane, camera).distance_m;
  return distance_m > 0 && distance_m < kFarthestTable_m;
}

PlaneSupport supportOf(const InverseDepth& inverse, const PlaneSums& sums, std::int32_t tolerance, double distance_m) {
  constexpr int kRowStep = 8;  // an eighth of the heights gives their mean square as well
  std::int64_t squares_um2 = 0, heights = 0;
  for (int v = 0; v < inverse.height_px; v += kRowStep) {
    const SquareSum row = squaresInRow(inverse.row(v), sums.columns.data(), sums.rows[static_cast<std::size_t>(v)],
                                       tolerance, static_cast<float>(distance_m * 1e6), inverse.width_px);
    squares_um2 += row.squares_um2;
    heights += row.heights;
  }
  PlaneSupport support;
  support.inliers = countInliers(inverse, sums, tolerance);
  if (heights > 0)
    support.residual_mm = std::sqrt(static_cast<double>(squares_um2) / static_cast<double>(heights)) * 1e-3;
  return support;
}

}  // namespace voxid
