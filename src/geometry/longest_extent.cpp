// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/geometry/longest_extent.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace voxid {
namespace {

constexpr std::size_t kMostPoints = 1024;

/// The least of many numbers, but for a few.
class Least {
 public:
  /// `left_out`: 0 to 3.
  explicit Least(std::size_t left_out) : last_(left_out) { kept_.fill(std::numeric_limits<float>::infinity()); }

  void add(float value) {
    if (value >= kept_[last_]) return;
    std::size_t place = last_;
    for (; place > 0 && value < kept_[place - 1]; --place) kept_[place] = kept_[place - 1];
    kept_[place] = value;
  }
  float last() const { return kept_[last_]; }

 private:
  std::array<float, 4> kept_;
  std::size_t last_;
};

}  // namespace

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
  constexpr float kUmPerMm = 1000;
  x_mm_.clear();
  y_mm_.clear();
  z_mm_.clear();
  const std::size_t step = std::max<std::size_t>(1, (pixels.size + kMostPoints - 1) / kMostPoints);
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

float LongestExtent::spreadAlong(float x, float y, float z) const {
  constexpr double kLeftOut = 0.003;
  const std::size_t count = x_mm_.size();
  const auto left_out = static_cast<std::size_t>(kLeftOut * static_cast<double>(count - 1));
  Least low(left_out), high(left_out);
  for (std::size_t i = 0; i < count; ++i) {
    const float along_mm = x * x_mm_[i] + y * y_mm_[i] + z * z_mm_[i];
    low.add(along_mm);
    high.add(-along_mm);
  }
  return -high.last() - low.last();
}

}  // namespace voxid
