// SPDX-License-Identifier: BSD-3-Clause
#include "join.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <utility>

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
constexpr int kTouchGap_px = 4;
constexpr int kRimsWithin_mm = 8;
constexpr std::int64_t kWidestVessel_um = 400000;
constexpr std::int64_t kFewestSagitta_um = 8000;

constexpr int kTopPercentile = 97;
constexpr int kHighest_mm = 2000;

std::int32_t inverseOf(std::int32_t depth_um) {
  return static_cast<std::int32_t>(kUnitsTimesUm / std::max(depth_um, 1000) + 0.5);
}

/// Directions in the plan: away from the camera's foot through a piece, and to the right of that.
struct ViewerAxes {
  std::int64_t away_x_q15, away_y_q15;
};

struct Extent {
  std::int64_t low = std::numeric_limits<std::int32_t>::max(), high = std::numeric_limits<std::int32_t>::min();
  void add(std::int64_t x) {
    low = std::min(low, x);
    high = std::max(high, x);
  }
  std::int64_t size() const { return high - low; }
};

Extent united(const Extent& a, const Extent& b) { return {std::min(a.low, b.low), std::max(a.high, b.high)}; }
std::int64_t overlapOf(const Extent& a, const Extent& b) { return std::min(a.high, b.high) - std::max(a.low, b.low); }

/// A piece from above: its extents, and how much farther its middle lies than its ends (positive: hollow to the
/// viewer).
struct PlanShape {
  Extent across, away;
  std::int64_t sagitta_um = 0;
};

ViewerAxes axesTowards(Span<const std::uint32_t> pixels, const Surface& surface) {
  std::int64_t x = 0, y = 0;
  for (const std::uint32_t pixel : pixels) {
    const Point2 p = surface.plan.project(surface.point(pixel));
    x += p.x;
    y += p.y;
  }
  const double dx = static_cast<double>(x), dy = static_cast<double>(y);
  const double length = std::max(1.0, std::sqrt(dx * dx + dy * dy));
  return {std::llround(dx / length * 32768), std::llround(dy / length * 32768)};
}

struct Mean {
  std::int64_t sum = 0, count = 0;
  void add(std::int64_t x) {
    sum += x;
    ++count;
  }
  std::int64_t value() const { return count > 0 ? sum / count : 0; }
};

PlanShape shapeOf(Span<const std::uint32_t> pixels, const Surface& surface, const ViewerAxes& axes) {
  const auto placed = [&](std::uint32_t pixel) {
    const Point2 p = surface.plan.project(surface.point(pixel));
    return std::make_pair((axes.away_y_q15 * p.x - axes.away_x_q15 * p.y) >> 15,
                          (axes.away_x_q15 * p.x + axes.away_y_q15 * p.y) >> 15);
  };
  PlanShape shape;
  for (const std::uint32_t pixel : pixels) {
    const auto [across, away] = placed(pixel);
    shape.across.add(across);
    shape.away.add(away);
  }
  Mean ends, middle;  // the outer and the inner fifths
  for (const std::uint32_t pixel : pixels) {
    const auto [across, away] = placed(pixel);
    const std::int64_t share_percent = 100 * (across - shape.across.low) / (shape.across.size() + 1);
    if (share_percent < 10 || share_percent >= 90) ends.add(away);
    if (share_percent >= 40 && share_percent < 60) middle.add(away);
  }
  if (ends.count > 0 && middle.count > 0) shape.sagitta_um = middle.value() - ends.value();
  return shape;
}

}  // namespace

Joiner::Joiner() {
  lines_.resize((kMostPieces + 1) * (kMostPieces + 1));
  heights_mm_.resize(kHighest_mm + 1);
  pieces_.reserve(kMostPieces + 1);
}

void Joiner::reserve(std::size_t pixels) { piece_.reserve(pixels); }

void Joiner::takePieces(const Surface& surface, std::size_t fewest, const Components& components) {
  piece_.assign(surface.inverse.values.size(), 0);
  for (bool all = false; !all; fewest *= 2) {  // a noisy frame: only its larger parts
    pieces_.assign(1, Piece{});
    all = true;
    for (std::size_t part = 0; part < components.parts() && all; ++part) {
      if (components.pixelsOf(part).size < fewest) continue;
      all = pieces_.size() <= kMostPieces;
      if (all) pieces_.push_back({part, -1});
    }
  }
  for (std::size_t i = 1; i < pieces_.size(); ++i) {
    for (const std::uint32_t pixel : components.pixelsOf(pieces_[i].part)) piece_[pixel] = static_cast<std::uint8_t>(i);
    for (std::size_t k = 1; k < pieces_.size(); ++k) lines(static_cast<int>(i), static_cast<int>(k)) = Lines{};
  }
}

/// From the first pixel of a run back to the piece that it faces.
void Joiner::faceBack(const InverseDepth& inverse, std::size_t pixel, std::size_t stride, int farthest_px) {
  const int here = piece_[pixel];
  const std::int32_t depth_um = depthUmOf(inverse.values[pixel]);
  const std::int32_t nearest = inverseOf(depth_um - kDepthsWithin_um),
                     farthest = inverseOf(depth_um + kDepthsWithin_um);
  std::int32_t between = inverseOf(1000);  // the farthest depth seen between the two
  for (int k = 1; k <= farthest_px; ++k) {
    const std::size_t p = pixel - static_cast<std::size_t>(k) * stride;
    const std::int32_t value = inverse.values[p];
    const int other = piece_[p];
    if (other == here) return;
    if (other != 0 && value >= farthest && value <= nearest) {
      Lines& pair = lines(std::min(here, other), std::max(here, other));
      ++pair.facing;
      pair.hidden += k > 1 && between >= inverseOf(std::min(depth_um, depthUmOf(value)) - kNearer_um);
      return;
    }
    if (value > 0) between = std::min(between, value);
  }
}

void Joiner::scan(const InverseDepth& inverse, std::size_t first, std::size_t stride, int length, double focal_px) {
  for (int i = 1; i < length; ++i) {
    const std::size_t pixel = first + static_cast<std::size_t>(i) * stride;
    if (piece_[pixel] == 0 || piece_[pixel] == piece_[pixel - stride]) continue;
    const double gap_px = kWidestGap_um * focal_px / depthUmOf(inverse.values[pixel]);
    faceBack(inverse, pixel, stride, gap_px < i ? static_cast<int>(gap_px) : i);
    if (stride > 1) touch(inverse, pixel, i);
  }
}

/// Counts a column in which a far piece ends right above the first pixel of a near one.
void Joiner::touch(const InverseDepth& inverse, std::size_t pixel, int row) {
  const int near = piece_[pixel];
  for (int k = 1; k <= std::min(kTouchGap_px, row); ++k) {
    const std::size_t above = pixel - static_cast<std::size_t>(k) * static_cast<std::size_t>(inverse.width_px);
    const int far = piece_[above];
    if (far == 0) continue;
    if (far != near && inverse.values[above] < inverse.values[pixel]) ++lines(far, near).touching;
    return;
  }
}

bool Joiner::join(const Surface& surface, const Camera& camera, std::size_t fewest, Components& components) {
  takePieces(surface, fewest, components);
  const InverseDepth& inverse = surface.inverse;
  const auto width = static_cast<std::size_t>(inverse.width_px);
  for (int v = 0; v < inverse.height_px; ++v) {
    scan(inverse, static_cast<std::size_t>(v) * width, 1, inverse.width_px, camera.fx_q16 / 65536.0);
  }
  for (std::size_t u = 0; u < width; ++u) scan(inverse, u, width, inverse.height_px, camera.fy_q16 / 65536.0);
  bool any = false;
  const auto count = static_cast<int>(pieces_.size());
  for (int a = 1; a < count; ++a) {
    for (int b = a + 1; b < count; ++b) {
      if (!belongTogether(a, b, surface, components)) continue;
      components.uniteParts(pieces_[static_cast<std::size_t>(a)].part, pieces_[static_cast<std::size_t>(b)].part);
      any = true;
    }
  }
  return any;
}

bool Joiner::belongTogether(int a, int b, const Surface& surface, const Components& components) {
  const int width_px = surface.inverse.width_px;
  const bool cut = cutByNearer(a, b, std::max(2, kFewestLines * width_px / 640));
  const int fewest_columns = std::max(4, kFewestTouching * width_px / 640);
  const bool a_above = lines(a, b).touching >= fewest_columns, b_above = lines(b, a).touching >= fewest_columns;
  if (!cut && !a_above && !b_above) return false;
  Piece &first = pieces_[static_cast<std::size_t>(a)], &second = pieces_[static_cast<std::size_t>(b)];
  const int step_mm = std::abs(topOf(first, surface, components) - topOf(second, surface, components));
  if (cut && step_mm <= kCutTopsWithin_mm) return true;
  if (step_mm > kRimsWithin_mm) return false;
  return (a_above && wallsOfVessel(first, second, surface, components)) ||
         (b_above && wallsOfVessel(second, first, surface, components));
}

bool Joiner::cutByNearer(int a, int b, int fewest_lines) {
  const Lines& pair = lines(a, b);
  return pair.hidden >= fewest_lines && pair.hidden * 100 >= pair.facing * kHiddenShare_percent;
}

/// A vessel's far wall, seen from inside, is hollow towards the viewer, its near wall bulges.
bool Joiner::wallsOfVessel(const Piece& far, const Piece& near, const Surface& surface,
                           const Components& components) const {
  const Span<const std::uint32_t> far_pixels = components.pixelsOf(far.part),
                                  near_pixels = components.pixelsOf(near.part);
  const ViewerAxes axes = axesTowards(far_pixels, surface);
  const PlanShape far_shape = shapeOf(far_pixels, surface, axes), near_shape = shapeOf(near_pixels, surface, axes);
  const Extent across = united(far_shape.across, near_shape.across), away = united(far_shape.away, near_shape.away);
  if (across.size() > kWidestVessel_um || away.size() > kWidestVessel_um) return false;
  if (2 * overlapOf(far_shape.across, near_shape.across) <
      std::min(far_shape.across.size(), near_shape.across.size())) {
    return false;
  }
  return far_shape.sagitta_um > kFewestSagitta_um && near_shape.sagitta_um < 0;
}

int Joiner::topOf(Piece& piece, const Surface& surface, const Components& components) {
  if (piece.top_mm >= 0) return piece.top_mm;
  const Span<const std::uint32_t> pixels = components.pixelsOf(piece.part);
  std::fill(heights_mm_.begin(), heights_mm_.end(), 0);
  for (const std::uint32_t pixel : pixels) {
    const int height_mm = surface.plan.heightUm(surface.point(pixel)) / 1000;
    ++heights_mm_[static_cast<std::size_t>(std::clamp(height_mm, 0, kHighest_mm))];
  }
  std::size_t below = 0;
  int top_mm = -1;
  while (below * 100 < pixels.size * kTopPercentile) below += heights_mm_[static_cast<std::size_t>(++top_mm)];
  return piece.top_mm = top_mm;
}

}  // namespace voxid
