// SPDX-License-Identifier: BSD-3-Clause
#include "enclosure.h"

#include <algorithm>
#include <utility>

namespace voxid {
namespace {

constexpr int kFarthest_px = 32;  // at 640 columns; what a vessel's wall hides of its floor from the projector
constexpr int kBehind_mm = 15;
constexpr int kMostOfNone_px = 4;        // of these with depth, but of no piece
constexpr int kFewestWall_percent = 10;  // of a border that a second wall takes

/// How often each piece is faced.
struct Faced {
  std::array<int, 256> pieces{};  // those of the first face none
  int border = 0;

  void add(std::uint8_t piece) {
    ++pieces[piece];
    ++border;
  }
  int none() const { return pieces[0]; }
  /// The piece that is faced most, and not yet taken; 0 if hardly any is left.
  int takeMost(std::uint8_t& piece) {
    const auto most = std::max_element(pieces.begin() + 1, pieces.end());
    const int times = std::exchange(*most, 0);
    if (times == 0 || times * 100 < border * kFewestWall_percent) return 0;
    piece = static_cast<std::uint8_t>(most - pieces.begin());
    return times;
  }
};

/// Looks away from the border of one piece.
class Outlook {
 public:
  Outlook(const InverseDepth& inverse, const std::uint8_t* pieces, std::uint8_t own)
      : inverse_(inverse), pieces_(pieces), own_(own), farthest_px_(kFarthest_px * inverse.width_px / 640) {}

  int width_px() const { return inverse_.width_px; }
  int height_px() const { return inverse_.height_px; }
  int step() const { return std::max(1, inverse_.width_px / 320); }  // of rows and columns every second, at 640

  /// Adds the piece that is met first beyond `pixel`, which is of our own, in direction of the stride: none if it is
  /// far or lies behind. Where we go on ourselves there is no border.
  void look(std::uint32_t pixel, int stride, int pixels_left, Faced& faced) const {
    const std::uint8_t* const pieces = pieces_ + pixel;
    const std::int32_t* const values = inverse_.values.data() + pixel;
    const int farthest_px = std::min(pixels_left, farthest_px_);
    int of_none = 0;
    for (int k = 1; k <= farthest_px && of_none <= kMostOfNone_px; ++k) {
      const std::uint8_t met = pieces[k * stride];
      if (met == own_) return;
      if (met != 0) return faced.add(liesBehind(values[k * stride], *values) ? 0 : met);
      of_none += values[k * stride] != 0;
    }
    faced.add(0);
  }

 private:
  bool liesBehind(std::int32_t other, std::int32_t here) const { return other < here && !step_.within(other, here); }

  const InverseDepth& inverse_;
  const DepthStep step_{kBehind_mm};
  const std::uint8_t* pieces_;
  std::uint8_t own_;
  int farthest_px_;
};

void lookAlongRows(const Outlook& outlook, Span<const Run> runs, Faced& faced) {
  const auto width = static_cast<std::uint32_t>(outlook.width_px()), step = static_cast<std::uint32_t>(outlook.step());
  for (const Run& run : runs) {
    const std::uint32_t v = run.begin / width, u = run.begin - v * width;
    if (v % step != 0) continue;
    outlook.look(run.begin, -1, static_cast<int>(u), faced);
    outlook.look(run.end - 1, 1, static_cast<int>(width - u - run.size()), faced);
  }
}

void lookAlongColumns(const Outlook& outlook, Span<const Run> runs, Faced& faced) {
  const int width = outlook.width_px();
  const auto step = static_cast<std::uint32_t>(outlook.step());
  for (const Run& run : runs) {
    const int v = static_cast<int>(run.begin) / width;
    for (std::uint32_t pixel = (run.begin + step - 1) / step * step; pixel < run.end; pixel += step) {
      outlook.look(pixel, -width, v, faced);
      outlook.look(pixel, width, outlook.height_px() - 1 - v, faced);
    }
  }
}

}  // namespace

Enclosure::Enclosure(const InverseDepth& inverse, const std::uint8_t* pieces, Span<const Run> runs, std::uint8_t own) {
  const Outlook outlook(inverse, pieces, own);
  Faced faced;
  lookAlongRows(outlook, runs, faced);
  if (faced.none() > faced.border / 2) return;  // most pieces; columns take longer
  lookAlongColumns(outlook, runs, faced);
  for (std::uint8_t& wall : walls_) {
    const int most = faced.takeMost(wall);
    percent_ += most * 100 / faced.border;
  }
}

}  // namespace voxid
