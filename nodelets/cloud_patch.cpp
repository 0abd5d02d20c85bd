// SPDX-License-Identifier: BSD-3-Clause
#include "cloud_patch.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "cloud_fields.h"

namespace voxid {
namespace {

constexpr std::size_t kMostPoints = 65536, kLeastPoints = 20;
constexpr double kLeastFocal_px = 50, kMostFocal_px = 2000;
constexpr double kWidest_px = 1024;  // of the drawing
constexpr int kMargin_px = 2;

/// Where a ray through the point meets the plane at depth 1, and the depth.
struct Ray {
  double x, y;
  float z;
};

std::vector<Ray> raysOf(const sensor_msgs::PointCloud2& cloud, const CloudFields& fields) {
  std::vector<Ray> rays;
  const std::uint64_t points = std::uint64_t{cloud.width} * cloud.height;
  const std::uint64_t every = std::max<std::uint64_t>(1, points / kMostPoints);
  for (std::uint64_t i = 0; i < points; i += every) {
    const auto u = static_cast<std::uint32_t>(i % cloud.width), v = static_cast<std::uint32_t>(i / cloud.width);
    const float x = fields.x(u, v), y = fields.y(u, v), z = fields.z(u, v);
    if (!std::isfinite(x) || !std::isfinite(y) || !(z > 0.01f && z < 65)) continue;
    const Ray ray{static_cast<double>(x) / static_cast<double>(z), static_cast<double>(y) / static_cast<double>(z), z};
    if (std::abs(ray.x) < 8 && std::abs(ray.y) < 8) rays.push_back(ray);
  }
  return rays;
}

/// The distance to the fourth neighbour: the spacing itself on a grid of pixels, and about it if points lie at random.
double spacingAt(const std::vector<Ray>& rays, const Ray& at) {
  std::array<double, 5> nearest;  // the first is the ray itself
  nearest.fill(1e9);
  for (const Ray& ray : rays) {
    const double square = (ray.x - at.x) * (ray.x - at.x) + (ray.y - at.y) * (ray.y - at.y);
    if (square >= nearest.back()) continue;
    nearest.back() = square;
    std::sort(nearest.begin(), nearest.end());
  }
  return std::sqrt(nearest.back());
}

double focalOf(const std::vector<Ray>& rays) {
  constexpr std::size_t kAsked = 64;
  std::vector<double> spacings;
  for (std::size_t i = 0; i < kAsked; ++i) spacings.push_back(spacingAt(rays, rays[i * rays.size() / kAsked]));
  std::nth_element(spacings.begin(), spacings.begin() + kAsked / 2, spacings.end());
  return std::clamp(1 / std::max(spacings[kAsked / 2], 1e-6), kLeastFocal_px, kMostFocal_px);
}

}  // namespace

Result<CloudPatch> CloudPatch::of(const sensor_msgs::PointCloud2& cloud) {
  const Result<CloudFields> fields = CloudFields::of(cloud);
  if (!fields.ok()) return fields.status;
  const std::vector<Ray> rays = raysOf(cloud, fields.value);
  if (rays.size() < kLeastPoints)
    return Status::badUse("the cloud has " + std::to_string(rays.size()) +
                          " finite points in front of the camera, expected the points of one object, at least " +
                          std::to_string(kLeastPoints) + ", in the camera's optical frame (z forward)");
  const auto [left, right] =
      std::minmax_element(rays.begin(), rays.end(), [](const Ray& a, const Ray& b) { return a.x < b.x; });
  const auto [top, bottom] =
      std::minmax_element(rays.begin(), rays.end(), [](const Ray& a, const Ray& b) { return a.y < b.y; });
  const double widest = std::max(right->x - left->x, bottom->y - top->y);
  const double focal_px = std::min(focalOf(rays), kWidest_px / std::max(widest, 1e-6));

  CloudPatch patch;
  const double cx = kMargin_px - focal_px * left->x, cy = kMargin_px - focal_px * top->y;
  patch.camera_ = Camera::fromPixels(focal_px, focal_px, cx, cy);
  patch.width_px_ = static_cast<int>(focal_px * right->x + cx) + 2 * kMargin_px;
  patch.height_px_ = static_cast<int>(focal_px * bottom->y + cy) + 2 * kMargin_px;
  patch.depth_m_.assign(static_cast<std::size_t>(patch.width_px_) * static_cast<std::size_t>(patch.height_px_), 0);
  for (const Ray& ray : rays) {
    const long u = std::lround(focal_px * ray.x + cx), v = std::lround(focal_px * ray.y + cy);
    float& depth = patch.depth_m_[static_cast<std::size_t>(v * patch.width_px_ + u)];
    if (depth == 0 || ray.z < depth) depth = ray.z;
  }
  for (std::size_t i = 0; i < patch.depth_m_.size(); ++i)
    if (patch.depth_m_[i] > 0) patch.pixels_.push_back(static_cast<std::uint32_t>(i));
  return patch;
}

DepthView CloudPatch::view() const {
  DepthView view;
  view.data = depth_m_.data();
  view.width_px = width_px_;
  view.height_px = height_px_;
  view.row_bytes = static_cast<std::size_t>(width_px_) * sizeof(float);
  view.unit = DepthUnit::MetreF32;
  view.camera = camera_;
  return view;
}

}  // namespace voxid
