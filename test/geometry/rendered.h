// SPDX-License-Identifier: BSD-3-Clause
// Depth images of tables with boxes, by formula.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "voxid/core/depth_view.h"

namespace voxid::test {

/// Metres on the table: x to the right, y away from the camera's foot, z up.
struct Box {
  double x, y, length, width, height;  ///< x, y: of the middle
  double turn_deg = 0;
  double bottom = 0;  ///< above the table
};

/// An open cylinder on the table; its wall has no thickness.
struct Vessel {
  double x, y, radius, height;
};

/// A camera above a rectangular table that looks down on it.
struct View {
  double camera_height_m = 0.6, pitch_deg = 40;
  double left_m = -0.5, right_m = 0.5, near_m = 0.3, far_m = 1.2;  ///< the table
  int width_px = 640, height_px = 480;

  double scale() const { return width_px / 640.0; }
  Camera camera() const {
    return Camera::fromPixels(525 * scale(), 525 * scale(), width_px / 2.0 - 0.5, height_px / 2.0 - 0.5);
  }
};

struct Image {
  int width_px, height_px;
  std::vector<std::uint16_t> millimetres;
  Camera camera;

  DepthView view() const {
    DepthView v;
    v.data = millimetres.data();
    v.width_px = width_px;
    v.height_px = height_px;
    v.row_bytes = static_cast<std::size_t>(width_px) * 2;
    v.unit = DepthUnit::MillimetreU16;
    v.camera = camera;
    return v;
  }
  std::uint16_t& at(int u, int v) { return millimetres[static_cast<std::size_t>(v) * width_px + u]; }
};

constexpr double kRadian = 3.14159265358979323846 / 180;

/// Depth at which the ray enters the box, or infinity.
inline double hitBox(const Eigen::Vector3d& from, const Eigen::Vector3d& ray, const Box& box) {
  const double c = std::cos(box.turn_deg * kRadian), s = std::sin(box.turn_deg * kRadian);
  const auto turned = [&](double x, double y, double z) { return Eigen::Vector3d(c * x + s * y, c * y - s * x, z); };
  const Eigen::Vector3d o = turned(from.x() - box.x, from.y() - box.y, from.z());
  const Eigen::Vector3d d = turned(ray.x(), ray.y(), ray.z());
  const Eigen::Vector3d low(-box.length / 2, -box.width / 2, box.bottom),
      high(box.length / 2, box.width / 2, box.height);
  double enter = 0, leave = 1e9;
  for (int i = 0; i < 3; ++i) {
    if (std::abs(d[i]) < 1e-12) {
      if (o[i] < low[i] || o[i] > high[i]) return std::numeric_limits<double>::infinity();
      continue;
    }
    const double a = (low[i] - o[i]) / d[i], b = (high[i] - o[i]) / d[i];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return enter <= leave && enter > 0 ? enter : std::numeric_limits<double>::infinity();
}

/// Depth at which the ray meets the vessel's wall, from outside or inside, or infinity.
inline double hitVessel(const Eigen::Vector3d& from, const Eigen::Vector3d& ray, const Vessel& vessel) {
  const double ox = from.x() - vessel.x, oy = from.y() - vessel.y;
  const double a = ray.x() * ray.x() + ray.y() * ray.y(), b = ox * ray.x() + oy * ray.y();
  const double root = b * b - a * (ox * ox + oy * oy - vessel.radius * vessel.radius);
  if (root < 0) return std::numeric_limits<double>::infinity();
  for (const double depth : {(-b - std::sqrt(root)) / a, (-b + std::sqrt(root)) / a}) {
    const double z = from.z() + depth * ray.z();
    if (depth > 0 && z >= 0 && z <= vessel.height) return depth;
  }
  return std::numeric_limits<double>::infinity();
}

inline double hitTable(const Eigen::Vector3d& from, const Eigen::Vector3d& ray, const View& view) {
  if (ray.z() >= 0) return std::numeric_limits<double>::infinity();
  const double depth = -from.z() / ray.z();
  const Eigen::Vector3d p = from + depth * ray;
  const bool on = p.x() >= view.left_m && p.x() <= view.right_m && p.y() >= view.near_m && p.y() <= view.far_m;
  return on ? depth : std::numeric_limits<double>::infinity();
}

/// Millimetres as a sensor without noise gives them. `ray` has length one along the optical axis, so hits are depths.
inline Image render(const View& view, const std::vector<Box>& boxes, const std::vector<Vessel>& vessels = {}) {
  Image image{view.width_px, view.height_px, {}, view.camera()};
  image.millimetres.assign(static_cast<std::size_t>(view.width_px) * view.height_px, 0);
  const double c = std::cos(view.pitch_deg * kRadian), s = std::sin(view.pitch_deg * kRadian);
  const Eigen::Vector3d from(0, 0, view.camera_height_m);
  for (int v = 0; v < view.height_px; ++v) {
    for (int u = 0; u < view.width_px; ++u) {
      const double x = (u - view.width_px / 2.0 + 0.5) / (525 * view.scale());
      const double y = (v - view.height_px / 2.0 + 0.5) / (525 * view.scale());
      const Eigen::Vector3d ray(x, c - y * s, -s - y * c);
      double depth = hitTable(from, ray, view);
      for (const Box& box : boxes) depth = std::min(depth, hitBox(from, ray, box));
      for (const Vessel& vessel : vessels) depth = std::min(depth, hitVessel(from, ray, vessel));
      if (depth < 10) image.at(u, v) = static_cast<std::uint16_t>(std::lround(depth * 1000));
    }
  }
  return image;
}

/// Where a point of the table's frame is in the camera's.
inline Eigen::Vector3d inCamera(const View& view, double x, double y, double z) {
  const double c = std::cos(view.pitch_deg * kRadian), s = std::sin(view.pitch_deg * kRadian);
  const double down = view.camera_height_m - z;
  return {x, down * c - y * s, y * c + down * s};
}

/// The same frame as 32FC1: metres, NaN where there is no depth.
inline std::vector<float> metresOf(const Image& image) {
  std::vector<float> metres;
  metres.reserve(image.millimetres.size());
  for (const std::uint16_t mm : image.millimetres) {
    metres.push_back(mm == 0 ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(mm / 1000.0));
  }
  return metres;
}

inline DepthView viewOf(const std::vector<float>& metres, const Image& image) {
  DepthView v = image.view();
  v.data = metres.data();
  v.row_bytes = static_cast<std::size_t>(image.width_px) * 4;
  v.unit = DepthUnit::MetreF32;
  return v;
}

}  // namespace voxid::test
