// SPDX-License-Identifier: BSD-3-Clause
// doc/descriptor.md gives the definition, the range of every integer here and the reason of every choice.
#include "voxid/core/descriptor.h"

#include <algorithm>
#include <cstdlib>

#include "pair_sampler.h"
#include "voxid/core/trace.h"

namespace voxid {
namespace {

constexpr std::uint32_t kMaxPoints = 65536;
constexpr int kFineBins = 128, kCoarseBins = 32, kKindBins = 64, kRatioBins = 64;
constexpr int kKinds = 3;

// ---- where the points are --------------------------------------------------------------------------------------

struct Box {
  PointUm least, most;
};

Box boxOf(Span<const PointUm> points) {
  Box box{points[0], points[0]};
  for (const PointUm& p : points) {
    box.least = {std::min(box.least.x, p.x), std::min(box.least.y, p.y), std::min(box.least.z, p.z)};
    box.most = {std::max(box.most.x, p.x), std::max(box.most.y, p.y), std::max(box.most.z, p.z)};
  }
  return box;
}

struct Vector {
  std::int64_t x = 0, y = 0, z = 0;
};

std::int64_t squaredNorm(Vector v) { return v.x * v.x + v.y * v.y + v.z * v.z; }

// Coordinates from the box's corner, shifted so that the largest extent lies in [2^19, 2^20): every later product is
// bounded whatever the input, and a cloud twice as large gives the same numbers.
class Frame {
 public:
  explicit Frame(const Box& box) : corner_{box.least.x, box.least.y, box.least.z} {
    const Vector e = relative(box.most);
    for (std::int64_t largest = std::max({e.x, e.y, e.z}); largest >= kExtent; largest >>= 1) ++right_;
    for (std::int64_t largest = std::max({e.x, e.y, e.z}); largest < kExtent / 2; largest <<= 1) ++left_;
  }

  Vector of(const PointUm& p) const {
    const Vector r = relative(p);
    return {r.x << left_ >> right_, r.y << left_ >> right_, r.z << left_ >> right_};
  }

 private:
  static constexpr std::int64_t kExtent = 1 << 20;

  Vector relative(const PointUm& p) const { return {p.x - corner_.x, p.y - corner_.y, p.z - corner_.z}; }

  Vector corner_;
  int left_ = 0, right_ = 0;
};

// ---- from a frame's coordinates to distances and to cells ------------------------------------------------------

std::uint64_t squareRoot(std::uint64_t n) {
  std::uint64_t root = 0;
  for (std::uint64_t bit = std::uint64_t{1} << 31; bit != 0; bit >>= 1) {
    if ((root | bit) * (root | bit) <= n) root |= bit;
  }
  return root;
}

// Distances in units of the normaliser D / 4096, D = 3.4 root mean square distances from the centroid, some 2.6 mean
// distances between points. Coordinates are clamped at 4 D from the centroid, where at most one point in 185 can lie.
class DistanceScale {
 public:
  static constexpr std::int64_t kUnits = 4096;
  static constexpr std::int64_t kClamp = 4 * kUnits;

  DistanceScale(Vector centroid, std::uint64_t mean_square) : centroid_(centroid) {
    constexpr std::uint64_t kFactorSquaredPercent = 1156;
    const std::uint64_t d = squareRoot(mean_square * kFactorSquaredPercent / 100);
    scale_ = static_cast<std::int64_t>((static_cast<std::uint64_t>(kUnits) << kShift) / d);
  }
  std::int16_t along(std::int64_t p, std::int64_t centre) const {
    const std::int64_t units = ((p - centre) * scale_ + (std::int64_t{1} << (kShift - 1))) >> kShift;
    return static_cast<std::int16_t>(std::min(std::max(units, -kClamp), kClamp));
  }
  const Vector& centroid() const { return centroid_; }

 private:
  static constexpr int kShift = 32;

  Vector centroid_;
  std::int64_t scale_;
};

// The grid is the cube of side D about the centroid; what lies outside counts in the nearest cell.
Cell cellOf(std::int16_t x, std::int16_t y, std::int16_t z) {
  constexpr int kHalf = DistanceScale::kUnits / 2, kCell = DistanceScale::kUnits / VoxelGrid::kSide;
  const auto along = [](int units) {
    return static_cast<std::uint8_t>((std::min(std::max(units, -kHalf), kHalf - 1) + kHalf) / kCell);
  };
  return {along(x), along(y), along(z)};
}

struct Sample {
  std::int16_t x, y, z;  // from the centroid, D / 4096
  Cell cell;
};

// floor(sqrt(i)): the bin of a squared distance / 1024, since a bin is 32 units wide.
constexpr int kRootTable = kFineBins * kFineBins;
using RootTable = std::array<std::uint8_t, kRootTable>;

RootTable makeRootTable() {
  RootTable roots{};
  for (int root = 0, i = 0; root < kFineBins; ++root) {
    for (; i < (root + 1) * (root + 1); ++i) roots[i] = static_cast<std::uint8_t>(root);
  }
  return roots;
}

std::uint32_t squaredDistance(const Sample& a, const Sample& b) {
  const auto square = [](std::int32_t d) { return static_cast<std::uint32_t>(d * d); };  // |d| <= 2^15
  return square(a.x - b.x) + square(a.y - b.y) + square(a.z - b.z);
}

// ---- counts ----------------------------------------------------------------------------------------------------

struct Counts {
  std::array<std::array<std::uint32_t, kFineBins>, kKinds> distance{};
  std::array<std::uint32_t, kRatioBins + 1> ratio{};  // the last one takes the lines that are not mixed
};

// Where a line counts, by its inner and set cells: looked up, since three branches that no predictor can learn cost
// more.
struct Verdict {
  std::uint8_t kind, ratio_bin;
};
constexpr int kTraceSide = 64;
using VerdictTable = std::array<Verdict, kTraceSide * kTraceSide>;

std::size_t entryOf(Trace line) { return std::size_t{line.inner} * kTraceSide + line.on; }

Verdict verdictOn(Trace line) {
  const LineKind kind = kindOf(line);
  const int ratio_bin = kind == LineKind::Mixed ? line.on * kRatioBins / line.inner : kRatioBins;
  return {static_cast<std::uint8_t>(kind), static_cast<std::uint8_t>(ratio_bin)};
}

VerdictTable makeVerdictTable() {
  VerdictTable table{};
  for (std::uint8_t inner = 0; inner < kTraceSide; ++inner) {
    for (std::uint8_t on = 0; on <= inner; ++on) table[entryOf({inner, on})] = verdictOn({inner, on});
  }
  return table;
}

// round(255 sqrt(count / pairs)); 260,100 = (2 x 255)^2 leaves the half that rounding needs.
std::uint8_t rootOfShare(std::uint64_t count, std::uint32_t pairs) {
  return static_cast<std::uint8_t>((squareRoot(count * 260100 / pairs) + 1) / 2);
}

// round(127.5 sqrt(count / pairs)): the weight of one half.
std::uint8_t halfRootOfShare(std::uint64_t count, std::uint32_t pairs) {
  return static_cast<std::uint8_t>((squareRoot(count * 65025 / pairs) + 1) / 2);
}

// Writes `bins` bins, each the sum of neighbouring fine ones.
template <typename CountOfFineBin>
std::uint8_t* writeMerged(std::uint8_t* out, int bins, std::uint32_t pairs, CountOfFineBin count) {
  const int merged = kFineBins / bins;
  for (int bin = 0; bin < bins; ++bin) {
    std::uint64_t sum = 0;
    for (int fine = bin * merged; fine < (bin + 1) * merged; ++fine) sum += count(fine);
    *out++ = rootOfShare(sum, pairs);
  }
  return out;
}

void write(const Counts& counts, std::uint32_t pairs, Descriptor& bins) {
  const auto all = [&](int fine) {
    return counts.distance[0][fine] + counts.distance[1][fine] + counts.distance[2][fine];
  };
  std::uint8_t* out = writeMerged(bins.data(), kCoarseBins, pairs, all);
  out = writeMerged(out, kFineBins, pairs, all);
  for (const auto& kind : counts.distance) {
    out = writeMerged(out, kKindBins, pairs, [&](int fine) { return kind[fine]; });
  }
  for (int bin = 0; bin < kRatioBins; ++bin) *out++ = halfRootOfShare(counts.ratio[bin], pairs);
}

// ---- which points ----------------------------------------------------------------------------------------------

// Keeps at most 65,536 of n points, evenly: the i-th kept is number floor(i n / kept).
class EvenChoice {
 public:
  explicit EvenChoice(std::uint64_t n) : n_(n), kept_(std::min<std::uint64_t>(n, kMaxPoints)) {}
  std::size_t kept() const { return static_cast<std::size_t>(kept_); }
  std::size_t indexOf(std::uint64_t i) const {
    return static_cast<std::size_t>(i / kept_ * n_ + i % kept_ * n_ / kept_);
  }

 private:
  std::uint64_t n_, kept_;
};

bool depthAt(const DepthView& depth, std::uint32_t pixel, int& u, int& v, std::int32_t& z_um) {
  const std::uint32_t row = pixel / static_cast<std::uint32_t>(depth.width_px);
  if (row >= static_cast<std::uint32_t>(depth.height_px)) return false;
  v = static_cast<int>(row);
  u = static_cast<int>(pixel % static_cast<std::uint32_t>(depth.width_px));
  z_um = depth.depthUm(u, v);
  return z_um != 0;
}

}  // namespace

const char* nameOf(DescribeStatus status) {
  switch (status) {
    case DescribeStatus::Ok:
      return "OK";
    case DescribeStatus::Empty:
      return "EMPTY";
    case DescribeStatus::Degenerate:
      return "DEGENERATE";
  }
  return "UNKNOWN";
}

struct Describer::Workspace {
  DescriptorParams params;
  RootTable roots = makeRootTable();
  VerdictTable verdicts = makeVerdictTable();
  VoxelGrid surface;
  std::array<PointUm, kMaxPoints> points;
  std::array<Sample, kMaxPoints> samples;

  Described describeKept(Span<const PointUm> kept);
  void place(Span<const PointUm> kept, const Frame& frame);
  DistanceScale distanceScale(Span<const PointUm> kept, const Frame& frame) const;
  void drawSurface(std::size_t points);
  Counts drawPairs(std::size_t points) const;
};

Described Describer::Workspace::describeKept(Span<const PointUm> kept) {
  if (kept.empty()) return {};
  const Box box = boxOf(kept);
  const bool all_equal = box.least.x == box.most.x && box.least.y == box.most.y && box.least.z == box.most.z;
  if (all_equal) return {DescribeStatus::Degenerate, {}};
  place(kept, Frame(box));
  drawSurface(kept.size);
  Described result{DescribeStatus::Ok, {}};
  write(drawPairs(kept.size), params.pairs, result.bins);
  return result;
}

// 65,536 points of squares below 3 x 2^40 sum to less than 2^58.
DistanceScale Describer::Workspace::distanceScale(Span<const PointUm> kept, const Frame& frame) const {
  const auto n = static_cast<std::int64_t>(kept.size);
  Vector sum;
  std::int64_t squares = 0;
  for (const PointUm& point : kept) {
    const Vector p = frame.of(point);
    sum = {sum.x + p.x, sum.y + p.y, sum.z + p.z};
    squares += squaredNorm(p);
  }
  const Vector centroid{sum.x / n, sum.y / n, sum.z / n};
  // sum of (p - c)^2 = sum of p^2 - 2 c sum of p + n c^2, exactly, for any c
  const std::int64_t about_centroid =
      squares - 2 * (centroid.x * sum.x + centroid.y * sum.y + centroid.z * sum.z) + n * squaredNorm(centroid);
  return DistanceScale(centroid, static_cast<std::uint64_t>(about_centroid / n));
}

void Describer::Workspace::place(Span<const PointUm> kept, const Frame& frame) {
  const DistanceScale scale = distanceScale(kept, frame);
  const Vector c = scale.centroid();
  for (std::size_t i = 0; i < kept.size; ++i) {
    const Vector p = frame.of(kept[i]);
    const std::int16_t x = scale.along(p.x, c.x), y = scale.along(p.y, c.y), z = scale.along(p.z, c.z);
    samples[i] = {x, y, z, cellOf(x, y, z)};
  }
}

void Describer::Workspace::drawSurface(std::size_t points) {
  surface.clear();
  for (std::size_t i = 0; i < points; ++i) surface.set(samples[i].cell);
  surface.thicken();
  surface.close();
}

Counts Describer::Workspace::drawPairs(std::size_t points) const {
  Counts counts;
  PairSampler pairs(params.seed, static_cast<std::uint32_t>(points));
  for (std::uint32_t i = 0; i < params.pairs; ++i) {
    const auto [first, second] = pairs.next();
    const Sample &a = samples[first], &b = samples[second];
    const std::uint32_t bin_squared = squaredDistance(a, b) / 1024;
    const int distance_bin = bin_squared < kRootTable ? roots[bin_squared] : kFineBins - 1;
    const Verdict verdict = verdicts[entryOf(walk(surface, a.cell, b.cell))];
    ++counts.distance[verdict.kind][distance_bin];
    ++counts.ratio[verdict.ratio_bin];
  }
  return counts;
}

Describer::Describer(const DescriptorParams& params) : workspace_(std::make_unique<Workspace>()) {
  workspace_->params = params;
  workspace_->params.pairs = std::min(std::max(params.pairs, std::uint32_t{1}), kMaxPairs);
}

Describer::~Describer() = default;
Describer::Describer(Describer&&) noexcept = default;
Describer& Describer::operator=(Describer&&) noexcept = default;

const DescriptorParams& Describer::params() const { return workspace_->params; }

Described Describer::describe(Span<const PointUm> points) {
  const EvenChoice choice(points.size);
  if (choice.kept() == points.size) return workspace_->describeKept(points);
  for (std::size_t i = 0; i < choice.kept(); ++i) workspace_->points[i] = points[choice.indexOf(i)];
  return workspace_->describeKept({workspace_->points.data(), choice.kept()});
}

Described Describer::describe(const DepthView& depth, Span<const std::uint32_t> pixels) {
  if (depth.empty() || !depth.camera.valid()) return {};
  int u, v;
  std::int32_t z_um;
  std::size_t seen = 0;
  for (const std::uint32_t pixel : pixels) seen += depthAt(depth, pixel, u, v, z_um);
  const EvenChoice choice(seen);
  std::size_t number = 0, kept = 0;
  for (const std::uint32_t pixel : pixels) {
    if (kept == choice.kept()) break;
    if (!depthAt(depth, pixel, u, v, z_um) || number++ != choice.indexOf(kept)) continue;
    workspace_->points[kept++] = backProject(depth.camera, u, v, z_um);
  }
  return workspace_->describeKept({workspace_->points.data(), kept});
}

// In this form compilers find the instruction for sums of absolute differences (psadbw).
std::uint32_t l1(const std::uint8_t* a, const std::uint8_t* b) {
  int sum = 0;
  for (int i = 0; i < kDescriptorBytes; ++i) sum += std::abs(a[i] - b[i]);
  return static_cast<std::uint32_t>(sum);
}

}  // namespace voxid
