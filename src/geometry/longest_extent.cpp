// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/geometry/longest_extent.h"

#include <algorithm>
#include <cmath>

namespace voxid {

float LongestExtent::of_mm(const DepthView& depth, Span<const std::uint32_t> pixels) {
  constexpr int kDirections = 128;
  choosePoints(depth, pixels);
  float longest_mm = 0;
  for (int i = 0; i < kDirections && !x_mm_.empty(); ++i) {
    // Evenly over the half sphere: Fibonacci's spiral.
    const double z = (i + 0.5) / kDirections, turn = i * M_PI * (3 - std::sqrt(5.0)), across = std::sqrt(1 - z * z);
    longest_mm = std::max(longest_mm, spreadAlong(static_cast<float>(across * std::cos(turn)),
                                                  static_cast<float>(across * std::sin(turn)), static_cast<float>(z)));
  }
  return longest_mm;
}

void LongestExtent::choosePoints(const DepthView& depth, Span<const std::uint32_t> pixels) {
  constexpr std::size_t kMost = 1024;
  constexpr float kUmPerMm = 1000;
  x_mm_.clear();
  y_mm_.clear();
  z_mm_.clear();
  const std::size_t step = std::max<std::size_t>(1, (pixels.size + kMost - 1) / kMost);
  for (std::size_t i = 0; i < pixels.size; i += step) {
    const int u = static_cast<int>(pixels[i]) % depth.width_px, v = static_cast<int>(pixels[i]) / depth.width_px;
    const auto depth_um = depth.depthUm(u, v);
    if (depth_um <= 0) continue;
    const PointUm p = backProject(depth.camera, u, v, depth_um);
    x_mm_.push_back(static_cast<float>(p.x) / kUmPerMm);
    y_mm_.push_back(static_cast<float>(p.y) / kUmPerMm);
    z_mm_.push_back(static_cast<float>(p.z) / kUmPerMm);
  }
}

float LongestExtent::spreadAlong(float x, float y, float z) {
  constexpr double kLeftOut = 0.003;
  const std::size_t count = x_mm_.size();
  along_mm_.resize(count);
  for (std::size_t i = 0; i < count; ++i) along_mm_[i] = x * x_mm_[i] + y * y_mm_[i] + z * z_mm_[i];
  const auto out = static_cast<std::ptrdiff_t>(kLeftOut * static_cast<double>(count - 1));
  const auto low = along_mm_.begin() + out, high = along_mm_.end() - 1 - out;
  std::nth_element(along_mm_.begin(), low, along_mm_.end());
  const float least_mm = *low;
  std::nth_element(low, high, along_mm_.end());
  return *high - least_mm;
}

}  // namespace voxid
