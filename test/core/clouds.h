// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "voxid/core/depth_view.h"
#include "voxid/core/span.h"

namespace voxid::test {

/// Clouds by integer formulas, micrometres, as a camera sees them: the same points on every machine.
using Cloud = std::vector<PointUm>;

inline Span<const PointUm> spanOf(const Cloud& cloud) { return {cloud.data(), cloud.size()}; }

/// floor(sqrt(n)), n below 2^62.
inline std::int32_t root(std::int64_t n) {
  std::int64_t r = 0;
  for (std::int64_t bit = std::int64_t{1} << 30; bit != 0; bit >>= 1) {
    if ((r | bit) * (r | bit) <= n) r |= bit;
  }
  return static_cast<std::int32_t>(r);
}

/// The near cap of a sphere of 40 mm radius, a point every 1.6 mm.
inline Cloud sphereCap() {
  constexpr std::int32_t kRadius = 40000, kStep = 1600;
  Cloud cloud;
  for (std::int32_t y = -kRadius; y <= kRadius; y += kStep) {
    for (std::int32_t x = -kRadius; x <= kRadius; x += kStep) {
      const std::int64_t square = std::int64_t{kRadius} * kRadius - std::int64_t{x} * x - std::int64_t{y} * y;
      if (square > 0) cloud.push_back({x, y, 800000 - root(square)});
    }
  }
  return cloud;
}

/// Three faces of a box of 60 x 90 x 120 mm that meet in the near corner.
inline Cloud boxCorner() {
  Cloud cloud;
  for (std::int32_t a = 0; a <= 120000; a += 3000) {
    for (std::int32_t b = 0; b <= 90000; b += 3000) {
      cloud.push_back({0, b, 700000 + a});
      if (b <= 60000) cloud.push_back({b, 0, 700000 + a});
      if (a <= 60000) cloud.push_back({a, b, 700000});
    }
  }
  return cloud;
}

/// The front half of a cylinder of 40 mm radius and 95 mm height with a half ring for a handle.
inline Cloud mug() {
  Cloud cloud;
  for (std::int32_t y = 0; y <= 95000; y += 1900) {
    for (std::int32_t x = -39500; x <= 39500; x += 1580) {
      cloud.push_back({x, y, 900000 - root(std::int64_t{40000} * 40000 - std::int64_t{x} * x)});
    }
  }
  for (std::int32_t y = -30000; y <= 30000; y += 1500) {
    const std::int32_t outer = root(std::int64_t{30000} * 30000 - std::int64_t{y} * y);
    const std::int64_t square = std::int64_t{22000} * 22000 - std::int64_t{y} * y;
    const std::int32_t inner = square > 0 ? root(square) : 0;
    for (std::int32_t x = inner; x <= outer; x += 1500) cloud.push_back({40000 + x, 47500 + y, 895000});
  }
  return cloud;
}

/// A flat strip of 300 x 30 mm, tilted away from the camera.
inline Cloud ruler() {
  Cloud cloud;
  for (std::int32_t x = 0; x <= 300000; x += 2500) {
    for (std::int32_t y = 0; y <= 30000; y += 2500) cloud.push_back({x, y, 600000 + x / 3 + y / 5});
  }
  return cloud;
}

}  // namespace voxid::test
