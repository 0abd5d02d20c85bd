// SPDX-License-Identifier: BSD-3-Clause
#include "join.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "../core/vectorised.h"
#include "box.h"
#include "enclosure.h"
#include "plan_shape.h"

namespace voxid {
namespace {

// Occlusion join. Real things cut in two end at the same height; the plateau of the gap is 20 to 30 cm, of the tops 5
// to 15 mm.
constexpr std::int32_t kWidestGap_um = 200000;
constexpr std::int32_t kDepthsWithin_um = 30000;
constexpr std::int32_t kNearer_um = 10000;
constexpr int kFewestLines = 6;  // at 640 columns
constexpr int kHiddenShare_percent = 60;
constexpr int kCutTopsWithin_mm = 10;
// Hollow join.
constexpr int kFewestTouching = 20;  // columns, at 640
constexpr std::size_t kTouchGap_px = 4;
constexpr int kRimsWithin_mm = 8;
constexpr std::int64_t kWidestVessel_um = 400000;
constexpr std::int64_t kFewestSagitta_um = 8000;
constexpr int kLeastEnclosed_percent = 75;
constexpr int kRimAbove_mm = 8;      // a floor's top
constexpr int kDepth_percent = 110;  // of its width; the back of a jar's belly is seen through its mouth only
constexpr std::int64_t kMostBulge_um = 2000;
// Pieces of what was turned.
constexpr int kArcPoints = 1024;  // of a piece, at least, where it has as many
constexpr int kNear_px = 8;       // at 640 columns
constexpr double kOffSight_mm = 30;
constexpr std::size_t kMiddles = 16;

constexpr int kRowStep = 4;  // of a part's rows every fourth shows its top and its shape as well

constexpr int kTopPercentile = 97;
constexpr int kHighest_mm = 2000;

std::int32_t inverseOf(std::int32_t depth_um) {
  return static_cast<std::int32_t>(kUnitsTimesUm / std::max(depth_um, 1000) + 0.5);
}

std::uint32_t roundedUp(std::uint32_t value, int step) {
  const auto unit = static_cast<std::uint32_t>(step);
  return (value + unit - 1) / unit * unit;
}

/// Of the image's lines every second one is looked at, from 640 columns on.
int lineStep(int width_px) { return std::max(1, width_px / 320); }

/// Between two pieces every fourth pixel of a line is looked at, at 640 columns: what cuts an object is wider.
int gapStep(int width_px) { return std::max(1, width_px / 160); }

SearchEnd endOfSearch(int own, std::int32_t own_um, std::int32_t least) {
  return {own, inverseOf(own_um + kDepthsWithin_um), inverseOf(own_um - kDepthsWithin_um), least};
}

/// visit(run) for the runs in every step-th of a part's rows.
template <typename Visit>
void visitRows(const Surface& surface, Span<const Run> runs, int step, Visit visit) {
  const int first_row = surface.row(runs[0].begin);
  for (const Run& run : runs) {
    if ((surface.row(run.begin) - first_row) % step == 0) visit(run);
  }
}

VOXID_VECTORISED std::uint32_t countBelow(std::int32_t limit, const std::int32_t* values, std::size_t count) {
  std::uint32_t below = 0;
  for (std::size_t i = 0; i < count; ++i) below += static_cast<std::uint32_t>(values[i] < limit);
  return below;
}

bool areNear(const PixelBox& a, const PixelBox& b, int most_px) {
  const auto apart = [](int begin_a, int size_a, int begin_b, int size_b) {
    return std::max(begin_a, begin_b) - std::min(begin_a + size_a, begin_b + size_b);
  };
  return apart(a.x, a.width, b.x, b.width) <= most_px && apart(a.y, a.height, b.y, b.height) <= most_px;
}

/// How far b lies beside the line from the camera's foot through a.
double offSight_mm(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return std::abs(a.x() * b.y() - a.y() * b.x()) / a.norm();
}

}  // namespace

Joiner::Joiner() {
  lines_.resize((kMostPieces + 1) * (kMostPieces + 1));
  pieces_.reserve(kMostPieces + 1);
}

void Joiner::reserve(std::size_t pixels) {
  piece_.reserve(pixels);
  heights_um_.reserve(pixels);
  placed_.reserve(pixels);
}

void Joiner::takePieces(const Surface& surface, std::size_t fewest, const Components& components) {
  piece_.assign(surface.inverse.values.size(), 0);
  for (bool all = false; !all; fewest *= 2) {  // a noisy frame: only its larger parts
    pieces_.assign(1, Piece{});
    all = true;
    for (std::size_t part = 0; part < components.parts() && all; ++part) {
      if (components.pixelsIn(part) < fewest) continue;
      all = pieces_.size() <= kMostPieces;
      if (all) {
        pieces_.emplace_back();
        pieces_.back().part = part;
      }
    }
  }
  for (std::size_t i = 1; i < pieces_.size(); ++i) {
    pieces_[i].box = pixelBoxOf(components.runsOf(pieces_[i].part), surface.inverse.width_px);
    for (const Run& run : components.runsOf(pieces_[i].part)) {
      std::memset(piece_.data() + run.begin, static_cast<int>(i), run.end - run.begin);
    }
    for (std::size_t k = 1; k < pieces_.size(); ++k) lines(static_cast<int>(i), static_cast<int>(k)) = Lines{};
  }
}

/// The piece that a line's pixel faces.
Joiner::Faced Joiner::facedBack(const InverseDepth& inverse, const Line& line, const SearchEnd& end) const {
  const int step = gapStep(inverse.width_px);
  std::int32_t between = inverseOf(1000);
  for (int k = 1; k <= line.farthest_px; k += step) {
    const std::size_t p = line.pixel - static_cast<std::size_t>(k) * line.stride;
    const int piece = piece_[p];
    const std::int32_t value = inverse.values[p];
    if (piece == end.own) return {};
    if (piece != 0 && value >= end.farthest && value <= end.nearest) return {piece, k, value, between};
    if (value == 0) continue;
    if (value < end.least) return {};
    between = std::min(between, value);
  }
  return {};
}

/// Counts a line that faces a piece with nothing but missing or nearer depth in between.
void Joiner::countHidden(const InverseDepth& inverse, const Line& line) {
  const int own = piece_[line.pixel], next = piece_[line.pixel - line.stride];
  const std::int32_t value = inverse.values[line.pixel], next_value = inverse.values[line.pixel - line.stride];
  if (next == own || (next == 0 && next_value > 0 && next_value <= value)) return;  // most lines end at once
  const std::int32_t own_um = depthUmOf(value);
  const Faced faced = facedBack(inverse, line, endOfSearch(own, own_um, inverseOf(own_um - kNearer_um)));
  if (faced.piece == 0 || faced.steps == 1) return;
  if (faced.between >= inverseOf(std::min(own_um, depthUmOf(faced.value)) - kNearer_um))
    ++linesOf(own, faced.piece).hidden;
}

/// visit(line) for the lines that may face another piece: to the left where the pieces' runs begin, and up where the
/// row above is another piece.
template <typename Visit>
void Joiner::visitLines(const Surface& surface, const Camera& camera, Span<const Run> runs, Visit visit) const {
  const InverseDepth& inverse = surface.inverse;
  const auto width = static_cast<std::size_t>(inverse.width_px);
  const double per_unit = kWidestGap_um / kUnitsTimesUm / 65536;
  const double columns_per_unit = camera.fx_q16 * per_unit, rows_per_unit = camera.fy_q16 * per_unit;
  const auto farthest = [&](double px_per_unit, std::size_t pixel, int most) {
    const double gap_px = px_per_unit * inverse.values[pixel];
    return gap_px < most ? static_cast<int>(gap_px) : most;
  };
  const int step = lineStep(inverse.width_px);
  const Run* above = runs.begin();
  for (const Run& run : runs) {
    const int row = surface.row(run.begin), column = static_cast<int>(run.begin) - row * inverse.width_px;
    if (column > 0 && row % step == 0) visit(Line{run.begin, 1, farthest(columns_per_unit, run.begin, column)});
    if (row == 0) continue;
    const std::uint32_t first = run.begin + static_cast<std::uint32_t>(column % step);
    visitUncovered(run, inverse.width_px, above, runs.end(), [&](std::uint32_t begin, std::uint32_t end) {
      std::uint32_t pixel = begin <= first ? first : first + roundedUp(begin - first, step);
      for (; pixel < end; pixel += static_cast<std::uint32_t>(step))
        visit(Line{pixel, width, farthest(rows_per_unit, pixel, row)});
    });
  }
}

/// Counts a column in which a far piece ends right above the first pixel of a near one.
void Joiner::countTouching(const InverseDepth& inverse, std::size_t pixel) {
  const auto width = static_cast<std::size_t>(inverse.width_px);
  const int near = piece_[pixel];
  for (std::size_t k = 1; k <= kTouchGap_px && k * width <= pixel; ++k) {
    const std::size_t above = pixel - k * width;
    const int far = piece_[above];
    if (far == 0) continue;
    if (far != near && inverse.values[above] < inverse.values[pixel]) ++lines(far, near).touching;
    return;
  }
}

/// The line's length up to the box's far side; 0 if it does not reach the box.
int Joiner::lengthInto(const PixelBox& box, const Line& line, int width_px) {
  const int v = static_cast<int>(line.pixel) / width_px, u = static_cast<int>(line.pixel) - v * width_px;
  const bool left = line.stride == 1;
  const int across = left ? v - box.y : u - box.x, width = left ? box.height : box.width;
  const int to_end = left ? u - box.x : v - box.y, length = left ? box.width : box.height;
  const bool reaches = across >= 0 && across < width && to_end > 0 && to_end - length < line.farthest_px;
  return reaches ? std::min(to_end, line.farthest_px) : 0;
}

/// How many lines of one piece face the other, whatever lies in between. They are long: not to be counted for all
/// pairs.
int Joiner::linesFacing(int from, int to, const Surface& surface, const Camera& camera, const Components& components) {
  const PixelBox box = piece(to).box;
  int facing = 0;
  visitLines(surface, camera, components.runsOf(piece(from).part), [&](Line line) {
    line.farthest_px = lengthInto(box, line, surface.inverse.width_px);
    if (line.farthest_px == 0) return;
    const std::int32_t own_um = depthUmOf(surface.inverse.values[line.pixel]);
    facing += facedBack(surface.inverse, line, endOfSearch(from, own_um, 0)).piece == to;
  });
  return facing;
}

void Joiner::join(const Surface& surface, const Camera& camera, std::size_t fewest, Components& components) {
  takePieces(surface, fewest, components);
  const auto count = static_cast<int>(pieces_.size());
  for (int i = 1; i < count; ++i) {
    visitLines(surface, camera, components.runsOf(piece(i).part), [&](const Line& line) {
      countHidden(surface.inverse, line);
      if (line.stride > 1) countTouching(surface.inverse, line.pixel);
    });
  }
  for (int a = 1; a < count; ++a) {
    for (int b = a + 1; b < count; ++b) {
      if (cutByNearer(a, b, surface, camera, components) || wallsOfVessel(a, b, surface, components) ||
          turnedAsOne(a, b, surface, components))
        components.join(piece(a).part, piece(b).part);
    }
    joinToWalls(a, surface, components);
  }
}

bool Joiner::topsWithin(int most_mm, int a, int b, const Surface& surface, const Components& components) {
  return std::abs(topOf(piece(a), surface, components) - topOf(piece(b), surface, components)) <= most_mm;
}

bool Joiner::cutByNearer(int a, int b, const Surface& surface, const Camera& camera, const Components& components) {
  const int width_px = surface.inverse.width_px, hidden = lines(a, b).hidden;
  if (hidden < std::max(2, kFewestLines * width_px / 640 / lineStep(width_px))) return false;
  if (!topsWithin(kCutTopsWithin_mm, a, b, surface, components)) return false;
  const int facing = linesFacing(a, b, surface, camera, components) + linesFacing(b, a, surface, camera, components);
  return hidden * 100 >= facing * kHiddenShare_percent;
}

/// Whether one is the far wall of a vessel and the other its near wall.
bool Joiner::wallsOfVessel(int a, int b, const Surface& surface, const Components& components) {
  const int width_px = surface.inverse.width_px;
  const int fewest_columns = std::max(4, kFewestTouching * width_px / 640 / lineStep(width_px));
  const bool a_above = lines(a, b).touching >= fewest_columns, b_above = lines(b, a).touching >= fewest_columns;
  if ((!a_above && !b_above) || !topsWithin(kRimsWithin_mm, a, b, surface, components)) return false;
  return (a_above && farAndNearWall(piece(a), piece(b), surface, components)) ||
         (b_above && farAndNearWall(piece(b), piece(a), surface, components));
}

/// A vessel's far wall, seen from inside, is hollow towards the viewer, its near wall bulges.
bool Joiner::farAndNearWall(const Piece& far, const Piece& near, const Surface& surface, const Components& components) {
  place(far, surface, components, kRowStep);
  const ViewerAxes axes = axesTowards(placed_);
  const PlanShape far_shape = shapeOf(axes, placed_);
  place(near, surface, components, kRowStep);
  const PlanShape near_shape = shapeOf(axes, placed_);
  if (united(far_shape, near_shape).isWiderThan(kWidestVessel_um)) return false;
  if (2 * overlapOf(far_shape.across, near_shape.across) <
      std::min(far_shape.across.size(), near_shape.across.size())) {
    return false;
  }
  return far_shape.sagitta_um > kFewestSagitta_um && near_shape.sagitta_um < 0;
}

/// Whether both are of one thing that was turned on a lathe or a wheel, whose waist or foot the split took for a
/// meeting.
bool Joiner::turnedAsOne(int a, int b, const Surface& surface, const Components& components) {
  if (!areNear(piece(a).box, piece(b).box, kNear_px * surface.inverse.width_px / 640)) return false;
  if (offSight_mm(middleOf(piece(a), surface, components), middleOf(piece(b), surface, components)) > kOffSight_mm)
    return false;  // which is seen at once
  const Arcs& arcs_a = arcsOf(piece(a), surface, components);
  return (arcs_a.front || arcs_a.back) && areCoaxial(arcs_a, arcsOf(piece(b), surface, components));
}

/// In the plan, millimetres, roughly: the mean of the middles of some of its runs.
const Eigen::Vector2d& Joiner::middleOf(Piece& piece, const Surface& surface, const Components& components) {
  if (!piece.middle.isZero()) return piece.middle;
  const Span<const Run> runs = components.runsOf(piece.part);
  const std::size_t step = (runs.size / kMiddles) | 1;  // odd, as a crescent has its runs in pairs
  int count = 0;
  for (std::size_t i = step / 2; i < runs.size; i += step, ++count) {
    const Point2 foot = surface.plan.project(surface.point((runs[i].begin + runs[i].end) / 2));
    piece.middle += Eigen::Vector2d(foot.x, foot.y);
  }
  return piece.middle /= 1000 * count;
}

const Arcs& Joiner::arcsOf(Piece& piece, const Surface& surface, const Components& components) {
  if (piece.arcs) return *piece.arcs;
  const auto pixels = static_cast<int>(components.pixelsIn(piece.part));
  place(piece, surface, components, std::clamp(pixels / kArcPoints, 1, kRowStep));
  return piece.arcs.emplace(voxid::arcsOf(surface.distance_m, placed_));
}

/// The points in every row_step-th of its rows.
void Joiner::place(const Piece& piece, const Surface& surface, const Components& components, int row_step) {
  placed_.clear(components.pixelsIn(piece.part));
  visitRows(surface, components.runsOf(piece.part), row_step, [&](const Run& run) { surface.place(run, placed_); });
}

/// Where a vessel's floor meets its walls is a crease, too, and the split makes two of it.
void Joiner::joinToWalls(int floor, const Surface& surface, Components& components) {
  const Enclosure enclosure(surface.inverse, piece_.data(), components.runsOf(piece(floor).part),
                            static_cast<std::uint8_t>(floor));
  if (enclosure.percent() < kLeastEnclosed_percent) return;
  place(piece(floor), surface, components, kRowStep);
  const ViewerAxes axes = axesTowards(placed_);
  const PlanShape inner = shapeOf(axes, placed_);
  if (bulgeOf(inner, placed_) > kMostBulge_um) return;  // as what lies in a vessel does
  const int floor_top_mm = topOf(piece(floor), surface, components);
  PlanShape outer;
  std::array<int, 2> walls{enclosure.walls()[0], enclosure.walls()[1]};
  for (int& wall : walls) {
    if (wall == 0) continue;
    place(piece(wall), surface, components, kRowStep);
    const PlanShape shape = shapeOf(axes, placed_);
    const bool stands_within = shape.across.size() < inner.across.size();
    if (stands_within || topOf(piece(wall), surface, components) < floor_top_mm + kRimAbove_mm) {
      wall = 0;
      continue;
    }
    outer = united(outer, shape);
  }
  outer.away.high = std::max(outer.away.high, outer.away.low + outer.across.size() * kDepth_percent / 100);
  if (!isWithin(inner, outer) || outer.isWiderThan(kWidestVessel_um)) return;
  for (const int wall : walls)
    if (wall != 0) components.join(piece(floor).part, piece(wall).part);
}

/// In whole millimetres, rounded down, at most kHighest_mm.
int Joiner::topOf(Piece& piece, const Surface& surface, const Components& components) {
  if (piece.top_mm >= 0) return piece.top_mm;
  heights_um_.resize(std::max(heights_um_.size(), components.pixelsIn(piece.part)));
  std::int32_t* end = heights_um_.data();
  visitRows(surface, components.runsOf(piece.part), kRowStep, [&](const Run& run) {
    surface.heights(run, end);
    end += run.size();
  });
  const auto samples = static_cast<std::size_t>(end - heights_um_.data());
  int low_mm = 0, high_mm = kHighest_mm;
  while (low_mm < high_mm) {
    const int middle_mm = (low_mm + high_mm) / 2;
    const std::size_t below = countBelow((middle_mm + 1) * 1000, heights_um_.data(), samples);
    if (below * 100 < samples * kTopPercentile)
      low_mm = middle_mm + 1;
    else
      high_mm = middle_mm;
  }
  return piece.top_mm = low_mm;
}

}  // namespace voxid
