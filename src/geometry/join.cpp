// SPDX-License-Identifier: BSD-3-Clause
#include "join.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

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
constexpr int kWidestVessel_um = 400000;
constexpr double kFewestSagitta_um = 8000;

constexpr int kTopPercentile = 97;
constexpr int kHighest_mm = 2000;

std::int32_t inverseOf(std::int32_t depth_um) {
  return static_cast<std::int32_t>(kUnitsTimesUm / std::max(depth_um, 1000) + 0.5);
}

}  // namespace

void Joiner::takePieces(const Surface& surface, std::size_t fewest, const Components& components) {
  lines_.resize((kMostPieces + 1) * (kMostPieces + 1));
  heights_mm_.resize(kHighest_mm + 1);
  pieces_.reserve(kMostPieces + 1);
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
  }
}

/// Counts a column in which a far piece ends right above a near one.
void Joiner::touch(const InverseDepth& inverse, std::size_t upper, std::size_t lower) {
  const int far = piece_[upper], near = piece_[lower];
  if (far == 0 || far == near || inverse.values[upper] >= inverse.values[lower]) return;
  ++lines(std::max(far, near), std::min(far, near)).touching;
}

bool Joiner::join(const Surface& surface, const Camera& camera, std::size_t fewest, Components& components) {
  takePieces(surface, fewest, components);
  const InverseDepth& inverse = surface.inverse;
  const auto width = static_cast<std::size_t>(inverse.width_px);
  for (int v = 0; v < inverse.height_px; ++v) {
    scan(inverse, static_cast<std::size_t>(v) * width, 1, inverse.width_px, camera.fx_q16 / 65536.0);
  }
  for (std::size_t u = 0; u < width; ++u) scan(inverse, u, width, inverse.height_px, camera.fy_q16 / 65536.0);
  const int fewest_lines = std::max(2, kFewestLines * inverse.width_px / 640);
  bool any = false;
  const int count = static_cast<int>(pieces_.size());
  for (int a = 1; a < count; ++a) {
    for (int b = a + 1; b < count; ++b) {
      if (!cutByNearer(a, b, fewest_lines)) continue;
      const int top_a = topOf(pieces_[static_cast<std::size_t>(a)], surface, components);
      const int top_b = topOf(pieces_[static_cast<std::size_t>(b)], surface, components);
      if (std::abs(top_a - top_b) > kCutTopsWithin_mm) continue;
      components.uniteParts(pieces_[static_cast<std::size_t>(a)].part, pieces_[static_cast<std::size_t>(b)].part);
      any = true;
    }
  }
  return any;
}

bool Joiner::cutByNearer(int a, int b, int fewest_lines) {
  const Lines& pair = lines(a, b);
  return pair.hidden >= fewest_lines && pair.hidden * 100 >= pair.facing * kHiddenShare_percent;
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
