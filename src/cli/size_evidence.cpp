// SPDX-License-Identifier: BSD-3-Clause
#include "size_evidence.h"

#include <yaml-cpp/yaml.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "sizes_yaml.h"

namespace voxid::cli {
namespace {

constexpr double kMmPerCm = 10;

// Evenly over the half sphere: Fibonacci's spiral.
Eigen::Vector3d directionOf(int i, int count) {
  const double z = (i + 0.5) / count, turn = i * M_PI * (3 - std::sqrt(5.0));
  const double across = std::sqrt(1 - z * z);
  return {across * std::cos(turn), across * std::sin(turn), z};
}

double spreadAlong(const Eigen::Vector3d& direction, const std::vector<Eigen::Vector3d>& points_mm,
                   std::vector<double>& along) {
  constexpr double kLeftOut = 0.003;
  along.clear();
  for (const Eigen::Vector3d& point : points_mm) along.push_back(direction.dot(point));
  const auto low = along.begin() + static_cast<std::ptrdiff_t>(kLeftOut * static_cast<double>(along.size() - 1));
  const auto high = along.end() - 1 - (low - along.begin());
  std::nth_element(along.begin(), low, along.end());
  const double least = *low;
  std::nth_element(along.begin(), high, along.end());
  return *high - least;
}

}  // namespace

double longestExtent_mm(const DepthView& depth, Span<const std::uint32_t> pixels) {
  constexpr int kDirections = 128;
  constexpr double kUmPerMm = 1000;
  std::vector<Eigen::Vector3d> points_mm;
  for (const std::uint32_t pixel : pixels) {
    const int u = static_cast<int>(pixel) % depth.width_px, v = static_cast<int>(pixel) / depth.width_px;
    const auto depth_um = depth.depthUm(u, v);
    if (depth_um <= 0) continue;
    const PointUm p = backProject(depth.camera, u, v, depth_um);
    points_mm.emplace_back(p.x / kUmPerMm, p.y / kUmPerMm, p.z / kUmPerMm);
  }
  double longest = 0;
  std::vector<double> along;
  for (int i = 0; i < kDirections && !points_mm.empty(); ++i)
    longest = std::max(longest, spreadAlong(directionOf(i, kDirections), points_mm, along));
  return longest;
}

SizeTable::SizeTable(const Index& index) : ranges_(index.categories().size) {
  const YAML::Node table = YAML::Load(kSizesYaml);
  const auto rangeOf = [&](const std::string& name) {
    for (std::uint32_t i = 0; i < ranges_.size(); ++i) {
      if (index.categoryName(i) == name) return &ranges_[i];
    }
    return static_cast<Range*>(nullptr);
  };
  for (const auto& entry : table["range_cm"]) {
    if (Range* const range = rangeOf(entry.first.as<std::string>()))
      *range = {entry.second[0].as<double>() * kMmPerCm, entry.second[1].as<double>() * kMmPerCm};
  }
  for (const auto& name : table["large"]) {
    if (Range* const range = rangeOf(name.as<std::string>()))
      range->least_mm = table["large_cm"].as<double>() * kMmPerCm;
  }
}

AllowedCategories SizeTable::allowed(double longest_mm, const AllowedCategories& among) const {
  AllowedCategories fit(ranges_.size());
  for (std::size_t i = 0; i < ranges_.size(); ++i) {
    const bool listed = among.empty() || among[i];
    fit[i] = listed && longest_mm >= ranges_[i].least_mm && longest_mm <= ranges_[i].most_mm;
  }
  return std::find(fit.begin(), fit.end(), true) == fit.end() ? among : fit;
}

}  // namespace voxid::cli
