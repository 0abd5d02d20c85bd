// SPDX-License-Identifier: BSD-3-Clause
#include "floors.h"

#include <algorithm>

namespace voxid {
namespace {

constexpr std::uint32_t kFewestPixels = 50;  // at 640 x 480, as the next one
// Real tables are up to 2.3 mm off their plane beside things, in the mean over 7 x 7 pixels (95 % of 77 scenes): what
// is lower than this, as in a roll of tape, is table.
constexpr std::int64_t kLeastHeight_um = 1500;
// A floor meets its walls along at least a third of its outline. What is seen through a handle does not.
constexpr std::int64_t kLeastContacts_percent = 120;  // of the root of its pixels

}  // namespace

bool FloorFinder::Hole::isFloor() const {
  const std::int64_t area = pixels, touching = contacts;
  return area >= kFewestPixels && height_um >= kLeastHeight_um * area &&
         10000 * touching * touching >= kLeastContacts_percent * kLeastContacts_percent * area;
}

void FloorFinder::reserve(std::size_t pixels, int width_px, int height_px) {
  above_.reserve(width_px, height_px);
  gaps_.reserve(pixels / 2 + 1);
  holes_.reserve(pixels / 2 + 1);
  floors_.reserve(pixels);
}

std::uint32_t FloorFinder::rootOf(std::uint32_t gap) {
  while (gaps_[gap].parent != gap) gap = gaps_[gap].parent = gaps_[gaps_[gap].parent].parent;
  return gap;
}

void FloorFinder::unite(std::uint32_t a, std::uint32_t b) {
  a = rootOf(a);
  b = rootOf(b);
  const bool open = gaps_[a].open || gaps_[b].open;
  gaps_[std::max(a, b)].parent = std::min(a, b);
  gaps_[std::min(a, b)].open = open;
}

void FloorFinder::open(const Row& row) {
  for (std::size_t i = row.first_gap; i < row.end_gap; ++i) gaps_[rootOf(static_cast<std::uint32_t>(i))].open = true;
}

/// Opens the row's gaps that reach beyond the ends of another row, `shift` pixels before this one.
void FloorFinder::openBeyond(const Row& row, const Row& other, std::int64_t shift) {
  for (std::size_t i = row.first_gap; i < row.end_gap; ++i) {
    const Run& gap = gaps_[i].run;
    if (gap.begin - shift < other.begin || gap.end - shift > other.end)
      gaps_[rootOf(static_cast<std::uint32_t>(i))].open = true;
  }
}

void FloorFinder::linkRows(const Row& above, const Row& below, std::uint32_t width) {
  if (below.v != above.v + 1) {
    open(above);
    open(below);
    return;
  }
  openBeyond(above, below, -static_cast<std::int64_t>(width));
  openBeyond(below, above, width);
  std::size_t upper = above.first_gap;
  for (std::size_t lower = below.first_gap; lower < below.end_gap; ++lower) {
    const Run& gap = gaps_[lower].run;
    while (upper < above.end_gap && gaps_[upper].run.end + width <= gap.begin) ++upper;
    for (std::size_t i = upper; i < above.end_gap && gaps_[i].run.begin + width < gap.end; ++i)
      unite(static_cast<std::uint32_t>(lower), static_cast<std::uint32_t>(i));
  }
}

void FloorFinder::findGaps(const Surface& surface, Span<const Run> runs) {
  const auto width = static_cast<std::uint32_t>(surface.inverse.width_px);
  gaps_.clear();
  Row above{-2, 0, 0, 0, 0};
  for (std::size_t i = 0; i < runs.size; ++i) {
    const int v = surface.row(runs[i].begin);
    const std::uint32_t row_end = static_cast<std::uint32_t>(v + 1) * width;
    Row row{v, runs[i].begin, 0, gaps_.size(), 0};
    for (; i + 1 < runs.size && runs[i + 1].begin < row_end; ++i)
      gaps_.push_back({{runs[i].end, runs[i + 1].begin}, static_cast<std::uint32_t>(gaps_.size())});
    row.end = runs[i].end;
    row.end_gap = gaps_.size();
    linkRows(above, row, width);
    above = row;
  }
  open(above);
}

/// visit(u, v, pixel) for the pixels with depth that are not above the table.
template <typename Visit>
void FloorFinder::visitLow(const Surface& surface, const Run& run, Visit visit) const {
  const int v = surface.row(run.begin);
  int u = static_cast<int>(run.begin) - v * surface.inverse.width_px;
  for (std::uint32_t pixel = run.begin; pixel < run.end; ++pixel, ++u) {
    const std::int32_t value = surface.inverse.values[pixel];
    if (value != 0 && !above_.contains(value, u, v)) visit(u, v, pixel);
  }
}

/// How many of a pixel's four neighbours are above the table and at its depth. A hole does not reach the image's
/// border.
int FloorFinder::contactsOf(const Surface& surface, int u, int v, std::uint32_t pixel) const {
  const std::vector<std::int32_t>& values = surface.inverse.values;
  const auto width = static_cast<std::uint32_t>(surface.inverse.width_px);
  const auto meets = [&](std::uint32_t other, int other_u, int other_v) {
    return step_.within(values[pixel], values[other]) && above_.contains(values[other], other_u, other_v);
  };
  return meets(pixel - 1, u - 1, v) + meets(pixel + 1, u + 1, v) + meets(pixel - width, u, v - 1) +
         meets(pixel + width, u, v + 1);
}

void FloorFinder::measureHoles(const Surface& surface) {
  holes_.assign(gaps_.size(), Hole{});
  for (std::uint32_t i = 0; i < gaps_.size(); ++i) {
    const std::uint32_t root = rootOf(i);
    if (gaps_[root].open) continue;
    Hole& hole = holes_[root];
    visitLow(surface, gaps_[i].run, [&](int u, int v, std::uint32_t pixel) {
      ++hole.pixels;
      hole.height_um += surface.plan.heightUm(surface.pointAt(u, v, pixel));
      hole.contacts += contactsOf(surface, u, v, pixel);
    });
  }
}

void FloorFinder::takeFloors(const Surface& surface) {
  floors_.clear();
  for (std::uint32_t i = 0; i < gaps_.size(); ++i) {
    if (!holes_[rootOf(i)].isFloor()) continue;
    visitLow(surface, gaps_[i].run, [&](int, int, std::uint32_t pixel) {
      if (!floors_.empty() && floors_.back().end == pixel)
        ++floors_.back().end;
      else
        floors_.push_back({pixel, pixel + 1});
    });
  }
}

void FloorFinder::addFloors(const Surface& surface, const SegmentParams& params, Components& components) {
  above_.set(surface.table, surface.distance_m, params.min_height_mm, params.max_height_mm, params.min_margin_per_km);
  step_ = DepthStep(params.cluster_gap_mm);
  for (std::size_t part = 0; part < components.parts(); ++part) {
    if (components.pixelsIn(part) < kFewestPixels) continue;
    findGaps(surface, components.runsOf(part));
    measureHoles(surface);
    takeFloors(surface);
    if (!floors_.empty()) components.add(part, {floors_.data(), floors_.size()});
  }
}

}  // namespace voxid
