// SPDX-License-Identifier: BSD-3-Clause
// doc/descriptor.md gives the definition, the range of every integer here and the reason of every choice.
#include "voxid/core/descriptor.h"

#include <algorithm>
#include <cstdlib>

#include "even_choice.h"
#include "line_walker.h"
#include "normaliser.h"
#include "pair_sampler.h"
#include "point_rows.h"
#include "vectorised.h"
#include "voxid/core/trace.h"

namespace voxid {
namespace {

constexpr int kFineBins = 128, kCoarseBins = 32, kKindBins = 64, kRatioBins = 64;
constexpr int kKinds = 3;

// ---- from a frame's coordinates to distances and to cells ------------------------------------------------------

// Distances in units of the normaliser, D / 4096. Coordinates are clamped at 4 D from the centroid, where at most one
// point in 185 can lie.
constexpr std::int64_t kUnits = 4096;
constexpr int kUnitShift = 32;
constexpr std::int64_t kUnitClamp = 4 * kUnits;

std::int64_t unitScaleOf(const Normaliser& n) {
  return static_cast<std::int64_t>((std::uint64_t{kUnits} << kUnitShift) / n.d);
}

VOXID_VECTORISED void toUnits(const std::int32_t* row, std::size_t size, std::int64_t centre, std::int64_t scale,
                              std::int16_t* units) {
  for (std::size_t i = 0; i < size; ++i) {
    const std::int64_t scaled = ((row[i] - centre) * scale + (std::int64_t{1} << (kUnitShift - 1))) >> kUnitShift;
    units[i] = static_cast<std::int16_t>(std::min(std::max(scaled, -kUnitClamp), kUnitClamp));
  }
}

// A point as one word, so that what a pair asks for is one read an end: x, y, z from the centroid in D / 4096, 16 bits
// each from the lowest.
using Place = std::uint64_t;

template <int kAxis>
std::int32_t along(Place place) {
  return static_cast<std::int16_t>(place >> 16 * kAxis);
}

VOXID_VECTORISED void toPlaces(const std::int16_t* x, const std::int16_t* y, const std::int16_t* z, std::size_t size,
                               Place* places) {
  const auto bits = [](std::int16_t units) { return Place{static_cast<std::uint16_t>(units)}; };
  for (std::size_t i = 0; i < size; ++i) places[i] = bits(x[i]) | bits(y[i]) << 16 | bits(z[i]) << 32;
}

// The grid is the cube of side D about the centroid; what lies outside counts in the nearest cell. orderOf().
inline __attribute__((always_inline)) std::uint32_t cellAt(Place place) {
  constexpr std::int32_t kHalf = kUnits / 2, kCell = kUnits / VoxelGrid::kSide;
  const auto cell = [](std::int32_t units) {
    return static_cast<std::uint32_t>(std::min(std::max(units, -kHalf), kHalf - 1) + kHalf) / kCell;
  };
  return cell(along<2>(place)) << 16 | cell(along<1>(place)) << 8 | cell(along<0>(place));
}

VOXID_VECTORISED void toCells(const Place* places, std::size_t size, std::uint32_t* cells) {
  for (std::size_t i = 0; i < size; ++i) cells[i] = cellAt(places[i]);
}

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

inline __attribute__((always_inline)) std::uint32_t squaredDistance(Place a, Place b) {
  const auto square = [](std::int32_t d) { return static_cast<std::uint32_t>(d * d); };  // |d| <= 2^15
  return square(along<0>(a) - along<0>(b)) + square(along<1>(a) - along<1>(b)) + square(along<2>(a) - along<2>(b));
}

// Of lines between places: their ends' cells, and the squares of their lengths in bins, below kRootTable.
VOXID_VECTORISED void measure(const Place* a, const Place* b, std::size_t lines, std::uint32_t* from, std::uint32_t* to,
                              std::uint32_t* bins_squared) {
  for (std::size_t i = 0; i < lines; ++i) {
    from[i] = cellAt(a[i]);
    to[i] = cellAt(b[i]);
    bins_squared[i] = std::min<std::uint32_t>(squaredDistance(a[i], b[i]) / 1024, kRootTable - 1);
  }
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
  LineWalker lines;
  std::array<Place, LineWalker::kLines> from, to;  // the ends of a batch of lines
  std::array<std::uint32_t, LineWalker::kLines> bins_squared;
  PointRows points;
  std::array<Place, kMaxPoints> places;

  Described describePoints();
  void place();
  void placeBlock(const Normaliser& normaliser, std::size_t first, std::size_t size);
  void fillSurface();
  Counts drawPairs(std::size_t points);
  void drawLines(std::size_t count, PairSampler& pairs);
  void countLines(std::size_t count, Counts& counts) const;
};

Described Describer::Workspace::describePoints() {
  if (points.size == 0) return {};
  const Box box = boxOf(points);
  if (isOnePoint(box)) return {DescribeStatus::Degenerate, {}};
  Frame(box).enter(points);
  place();
  fillSurface();
  Described result{DescribeStatus::Ok, {}};
  write(drawPairs(points.size), params.pairs, result.bins);
  return result;
}

constexpr std::size_t kBlock = 512;  // points whose units fit the L1 cache

void Describer::Workspace::place() {
  const Normaliser normaliser = normaliserOf(points);
  surface.clear();
  for (std::size_t first = 0; first < points.size; first += kBlock) {
    placeBlock(normaliser, first, std::min(kBlock, points.size - first));
  }
}

void Describer::Workspace::placeBlock(const Normaliser& normaliser, std::size_t first, std::size_t size) {
  const std::int64_t scale = unitScaleOf(normaliser);
  const Vector& c = normaliser.centroid;
  std::array<std::int16_t, kBlock> x, y, z;
  toUnits(&points.x[first], size, c.x, scale, x.data());
  toUnits(&points.y[first], size, c.y, scale, y.data());
  toUnits(&points.z[first], size, c.z, scale, z.data());
  toPlaces(x.data(), y.data(), z.data(), size, &places[first]);
  std::array<std::uint32_t, kBlock> cells;
  toCells(&places[first], size, cells.data());
  for (std::size_t i = 0; i < size; ++i) surface.set(cellOf(cells[i]));
}

void Describer::Workspace::fillSurface() {
  surface.thicken();
  surface.close();
}

Counts Describer::Workspace::drawPairs(std::size_t points) {
  Counts counts;
  PairSampler pairs(params.seed, static_cast<std::uint32_t>(points));
  lines.see(surface);
  for (std::size_t left = params.pairs; left > 0;) {
    const std::size_t batch = std::min(left, LineWalker::kLines);
    drawLines(batch, pairs);
    lines.walk(batch);
    countLines(batch, counts);
    left -= batch;
  }
  return counts;
}

void Describer::Workspace::drawLines(std::size_t count, PairSampler& pairs) {
  for (std::size_t i = 0; i < count; ++i) {
    const auto [first, second] = pairs.next();
    from[i] = places[first];
    to[i] = places[second];
  }
  measure(from.data(), to.data(), count, lines.from.data(), lines.to.data(), bins_squared.data());
}

void Describer::Workspace::countLines(std::size_t count, Counts& counts) const {
  for (std::size_t i = 0; i < count; ++i) {
    const Verdict verdict = verdicts[entryOf({lines.inner[i], lines.on[i]})];
    ++counts.distance[verdict.kind][roots[bins_squared[i]]];
    ++counts.ratio[verdict.ratio_bin];
  }
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
  workspace_->points.size = 0;
  for (std::size_t i = 0; i < choice.kept(); ++i) workspace_->points.add(points[choice.indexOf(i)]);
  return workspace_->describePoints();
}

Described Describer::describe(const DepthView& depth, Span<const std::uint32_t> pixels) {
  if (depth.empty() || !depth.camera.valid()) return {};
  PointRows& points = workspace_->points;
  points.size = 0;
  const BackProjector camera(depth.camera);
  forEachPixel(depth, pixels, [&](const Pixel& pixel) { points.add(camera.point(pixel.u, pixel.v, pixel.z_um)); });
  return workspace_->describePoints();
}

// In this form compilers find the instruction for sums of absolute differences (psadbw).
std::uint32_t l1(const std::uint8_t* a, const std::uint8_t* b) {
  int sum = 0;
  for (int i = 0; i < kDescriptorBytes; ++i) sum += std::abs(a[i] - b[i]);
  return static_cast<std::uint32_t>(sum);
}

}  // namespace voxid
