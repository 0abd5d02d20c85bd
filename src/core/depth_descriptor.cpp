// SPDX-License-Identifier: BSD-3-Clause
// doc/descriptor.md gives the definition, the range of every integer here and the reason of every choice.
#include "voxid/core/depth_descriptor.h"

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "depth_patch.h"
#include "even_choice.h"
#include "normaliser.h"
#include "pair_sampler.h"
#include "point_rows.h"
#include "vectorised.h"

namespace voxid {
namespace {

enum Histogram {
  kDistance,
  kLineParts,
  kLineKind,
  kLinePart,
  kSag,
  kNormals,
  kNormalsAndLine,
  kConvexity,
  kLineSlope,
  kAngleOfThree,
  kAreaOfThree,
  kRadius,
  kRadiusSlope,
  kRadiusAlong,
  kSlope,
  kSlopeDepth
};

// ---- small scales ----------------------------------------------------------------------------------------------

// 1024 cos(pi k / 64).
constexpr std::array<std::int16_t, 33> kCosines{1024, 1023, 1019, 1013, 1004, 993, 980, 964, 946, 926, 903,
                                                878,  851,  822,  792,  759,  724, 688, 650, 610, 569, 526,
                                                483,  438,  392,  345,  297,  249, 200, 150, 100, 50,  0};

int cosine(int k) {
  return k <= 32 ? kCosines[static_cast<std::size_t>(k)] : -kCosines[static_cast<std::size_t>(64 - k)];
}

// The angle of a cosine x 1024, in 64 equal parts of 180 degrees.
class AngleTable {
 public:
  AngleTable() {
    int part = 0;
    for (int c = 1024; c >= -1024; --c) {
      while (part < 63 && c <= cosine(part + 1)) ++part;
      parts_[static_cast<std::size_t>(c + 1024)] = static_cast<std::uint8_t>(part);
    }
  }
  int partOf(std::int32_t cosine_q10) const {
    return parts_[static_cast<std::size_t>(std::min(std::max(cosine_q10, -1024), 1024) + 1024)];
  }

 private:
  std::array<std::uint8_t, 2049> parts_;
};

// floor(sqrt(i)).
constexpr int kDistanceParts = 64;
class RootTable {
 public:
  RootTable() {
    for (int root = 0, i = 0; root < kDistanceParts; ++root) {
      for (; i < (root + 1) * (root + 1); ++i) roots_[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(root);
    }
  }
  // The distance in 1/64 of D; the last part takes what is farther.
  int partOf(std::uint32_t squared_units) const {
    const std::uint32_t squared_parts = squared_units >> 12;
    return squared_parts < roots_.size() ? roots_[squared_parts] : kDistanceParts - 1;
  }

 private:
  std::array<std::uint8_t, kDistanceParts * kDistanceParts> roots_;
};

// None, up to a third, up to two thirds, more of the 16 samples of a line.
constexpr std::array<std::uint8_t, 17> kThirds{0, 1, 1, 1, 1, 1, 2, 2, 2, 2, 2, 3, 3, 3, 3, 3, 3};

// ---- geometry --------------------------------------------------------------------------------------------------

Direction1024 normalOf(const SurfaceCell& cell) { return {cell.nx, cell.ny, cell.nz}; }

std::int32_t cosineOf(const Direction1024& a, const Direction1024& b) {
  return (a.x * b.x + a.y * b.y + a.z * b.z) / 1024;
}

struct Offset {
  std::int32_t x, y, z;  // |.| < 2^14
};
Offset between(const SurfaceCell& from, const SurfaceCell& to) { return {to.x - from.x, to.y - from.y, to.z - from.z}; }

std::uint32_t squared(const Offset& o) { return static_cast<std::uint32_t>(o.x * o.x + o.y * o.y + o.z * o.z); }

// Twice the area of a triangle, squared: components below 2^29, their squares sum to less than 2^60.
std::uint64_t squaredCross(const Offset& a, const Offset& b) {
  const std::int64_t x = std::int64_t{a.y} * b.z - std::int64_t{a.z} * b.y;
  const std::int64_t y = std::int64_t{a.z} * b.x - std::int64_t{a.x} * b.z;
  const std::int64_t z = std::int64_t{a.x} * b.y - std::int64_t{a.y} * b.x;
  return static_cast<std::uint64_t>(x * x + y * y + z * z);
}

// Sixty-four equal steps of the logarithm, from (D / 64)^2 to D^2 for an area whose square is given.
int areaPart(std::uint64_t squared_area) {
  if (squared_area < 16) return 0;
  const int high = 63 - __builtin_clzll(squared_area);
  const int quarters = 4 * high + static_cast<int>(squared_area >> (high - 2) & 3);
  return std::min(std::max((quarters - 4 * 24) * 2 / 3, 0), 63);
}

// ---- the line in the depth image -------------------------------------------------------------------------------

constexpr int kSamples = 16;

// What the samples of a line meet. They add up to kSamples.
struct LineParts {
  std::array<std::uint8_t, 4> samples{};  // on the surface, in front of it, behind it, outside the object
  std::int32_t sag = 0;                   // mean of (line's w - surface's w) where a surface is seen
};
enum Part { kOn, kInFront, kBehind, kOutside };

// As many pairs as walk their lines in step: a register of AVX-512.
constexpr std::size_t kGroup = 16;

// Pairs of cells, each with a third one.
struct Group {
  std::array<const SurfaceCell*, kGroup> first, second, third;
  std::size_t pairs = 0;
};

// One coordinate of the lines of a group, in 1/32 of its unit.
struct Lanes {
  std::array<std::int32_t, kGroup> at, step;

  // Sample k lies at t = (2 k + 1) / 32.
  void start(std::size_t line, std::int32_t from, std::int32_t to) {
    at[line] = 32 * from - (to - from);
    step[line] = 2 * (to - from);
  }
};

// A group that is not full repeats its first pair.
VOXID_VECTORISED void walk(const DepthPatch& patch, const Group& group, std::array<LineParts, kGroup>& lines) {
  constexpr std::int32_t kHalf = 16;
  const std::int32_t tolerance = patch.tolerance();
  const std::int32_t* const surface = patch.rows();
  Lanes column, row, w;
  for (std::size_t i = 0; i < kGroup; ++i) {
    const SurfaceCell &a = *group.first[i], &b = *group.second[i];
    column.start(i, a.column, b.column);
    row.start(i, a.row, b.row);
    w.start(i, a.w, b.w);
  }
  std::array<std::int32_t, kGroup> in_front{}, behind{}, outside{}, sag{};
  for (int k = 0; k < kSamples; ++k) {
    for (std::size_t i = 0; i < kGroup; ++i) {
      column.at[i] += column.step[i];
      row.at[i] += row.step[i];
      w.at[i] += w.step[i];
      const std::int32_t seen = surface[((row.at[i] + kHalf) >> 5) * DepthPatch::kSide + ((column.at[i] + kHalf) >> 5)];
      const std::int32_t hole = seen == DepthPatch::kHole, depth = ((w.at[i] >> 5) - seen) & (hole - 1);
      in_front[i] += depth < -tolerance;
      behind[i] += depth > tolerance;
      outside[i] += hole;
      sag[i] += depth;
    }
  }
  const auto count = [](std::int32_t samples) { return static_cast<std::uint8_t>(samples); };
  for (std::size_t i = 0; i < kGroup; ++i) {
    const std::int32_t met = kSamples - outside[i];
    lines[i] = {{count(met - in_front[i] - behind[i]), count(in_front[i]), count(behind[i]), count(outside[i])},
                met == 0 ? 0 : sag[i] / met};
  }
}

int kindOf(const LineParts& line) {
  return static_cast<int>(std::max_element(line.samples.begin(), line.samples.end()) - line.samples.begin());
}

}  // namespace

struct DepthDescriber::Workspace {
  DescriptorParams params;
  AngleTable angles;
  RootTable roots;
  DepthPatch patch;
  std::array<Pixel, kMaxPoints> pixels;
  PointRows points;
  std::array<std::uint32_t, kDepthBins> counts;

  DescribeStatus draw(const DepthView& depth, Span<const std::uint32_t> chosen);
  void count(Histogram histogram, int bin) {
    ++counts[kDepthHistograms[histogram].first_bin + static_cast<std::size_t>(bin)];
  }
  void countCells();
  void countCell(const SurfaceCell& cell);
  void countPairs();
  void countGroup(Group& group);
  void countPair(const SurfaceCell& a, const SurfaceCell& b, const SurfaceCell& c, const LineParts& parts);
  void countLine(const LineParts& line, int distance);
  void countNormals(const SurfaceCell& a, const SurfaceCell& b, const Direction1024& direction, int distance);
  void countThree(const Offset& line, const Direction1024& direction, const Offset& to_third);
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
  const Offset radius{cell.x, cell.y, cell.z};
  const int part = roots.partOf(4 * squared(radius));  // 1/128 of D: the centroid is at most some D / 2 away
  const int ring = part / 8;
  const int slope = std::min(-cell.nz / 16, 63);
  const int along = angles.partOf(cosineOf(normalOf(cell), normalised(radius.x, radius.y, radius.z)));
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
  const SurfaceCell* before = &cells[pairs.next().first];
  for (std::size_t left = params.pairs; left > 0;) {
    Group group;
    group.pairs = std::min(left, kGroup);
    for (std::size_t i = 0; i < group.pairs; ++i) {
      const auto [first, second] = pairs.next();
      group.first[i] = &cells[first];
      group.second[i] = &cells[second];
      group.third[i] = std::exchange(before, group.first[i]);
    }
    countGroup(group);
    left -= group.pairs;
  }
}

void DepthDescriber::Workspace::countGroup(Group& group) {
  for (std::size_t i = group.pairs; i < kGroup; ++i) {
    group.first[i] = group.first[0];
    group.second[i] = group.second[0];
  }
  std::array<LineParts, kGroup> lines;
  walk(patch, group, lines);
  for (std::size_t i = 0; i < group.pairs; ++i) {
    countPair(*group.first[i], *group.second[i], *group.third[i], lines[i]);
  }
}

void DepthDescriber::Workspace::countPair(const SurfaceCell& a, const SurfaceCell& b, const SurfaceCell& c,
                                          const LineParts& parts) {
  const Offset line = between(a, b);
  const Direction1024 direction = normalised(line.x, line.y, line.z);
  const int distance = roots.partOf(squared(line));
  count(kDistance, distance);
  countLine(parts, distance);
  countNormals(a, b, direction, distance);
  countThree(line, direction, between(a, c));
}

void DepthDescriber::Workspace::countLine(const LineParts& line, int distance) {
  const auto& n = line.samples;
  const int joint = (kThirds[n[kInFront]] * 4 + kThirds[n[kBehind]]) * 4 + kThirds[n[kOutside]];
  count(kLineParts, joint * 4 + distance / 16);
  count(kLineKind, kindOf(line) * 32 + distance / 2);
  for (int part = kInFront; part <= kOutside; ++part) {
    const int share = std::min((n[static_cast<std::size_t>(part)] + 1) / 2, 7);
    count(kLinePart, ((part - kInFront) * 8 + share) * 4 + distance / 16);
  }
  const int sag = std::min(std::max((line.sag + 8 * 128) / 128, 0), 15);
  count(kSag, sag * 8 + distance / 8);
}

// Which of the two points comes first is chance: nothing here depends on it.
void DepthDescriber::Workspace::countNormals(const SurfaceCell& a, const SurfaceCell& b, const Direction1024& direction,
                                             int distance) {
  const Direction1024 na = normalOf(a), nb = normalOf(b);
  const std::int32_t along_a = cosineOf(na, direction), along_b = -cosineOf(nb, direction);
  const int angle = angles.partOf(cosineOf(na, nb)), ring = distance / 8;
  const auto [least, most] = std::minmax({angles.partOf(along_a) / 8, angles.partOf(along_b) / 8});
  count(kNormals, angle / 4 * 8 + ring);
  count(kNormalsAndLine, (most * (most + 1) / 2 + least) * 8 + ring);
  const bool concave = along_a + along_b > 0;  // the normals lean towards each other
  count(kConvexity, (concave * 8 + std::min(angle / 4, 7)) * 8 + ring);
  count(kLineSlope, std::min(std::abs(direction.z) / 128, 7) * 8 + ring);
}

void DepthDescriber::Workspace::countThree(const Offset& line, const Direction1024& direction, const Offset& to_third) {
  const Direction1024 third = normalised(to_third.x, to_third.y, to_third.z);
  count(kAngleOfThree, angles.partOf(cosineOf(direction, third)));
  count(kAreaOfThree, areaPart(squaredCross(line, to_third)));
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
  return DescribeStatus::Ok;
}

}  // namespace voxid
