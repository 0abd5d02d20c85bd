// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "voxid/core/depth_view.h"
#include "voxid/core/span.h"

namespace voxid {

constexpr std::uint32_t kMaxPoints = 65536;  ///< that a descriptor looks at

/// Keeps at most 65,536 of n points, evenly: the i-th kept is number floor(i n / kept).
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

/// One pixel of an object with its depth, not zero.
struct Pixel {
  int u = 0, v = 0;
  std::int32_t z_um = 0;
};

/// False for a pixel (row * width + column) outside the image or without depth. `pixel` is what was asked for before,
/// or new: neighbours mostly share a row, and then nothing is divided.
inline bool pixelAt(const DepthView& depth, std::uint32_t number, Pixel& pixel) {
  const auto width = static_cast<std::uint32_t>(depth.width_px);
  std::uint32_t row = static_cast<std::uint32_t>(pixel.v), column = number - row * width;
  if (column >= width) {
    row = number / width;
    column = number % width;
  }
  if (row >= static_cast<std::uint32_t>(depth.height_px)) return false;
  pixel.v = static_cast<int>(row);
  pixel.u = static_cast<int>(column);
  pixel.z_um = depth.depthUm(pixel.u, pixel.v);
  return pixel.z_um != 0;
}

/// Calls take(pixel) for the pixels with depth, at most 65,536 of them, evenly chosen.
template <typename Take>
void forEachPixel(const DepthView& depth, Span<const std::uint32_t> pixels, Take take) {
  Pixel pixel;
  if (pixels.size <= kMaxPoints) {
    for (const std::uint32_t number : pixels) {
      if (pixelAt(depth, number, pixel)) take(pixel);
    }
    return;
  }
  std::size_t seen = 0;
  for (const std::uint32_t number : pixels) seen += pixelAt(depth, number, pixel);
  const EvenChoice choice(seen);
  std::size_t at = 0, kept = 0;
  for (const std::uint32_t number : pixels) {
    if (kept == choice.kept()) return;
    if (!pixelAt(depth, number, pixel) || at++ != choice.indexOf(kept)) continue;
    take(pixel);
    ++kept;
  }
}

}  // namespace voxid
