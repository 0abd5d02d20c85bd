// SPDX-License-Identifier: BSD-3-Clause
// A depth image of a table with a box and a ball on it, computed; so that a test knows what has to be found, and where.
#pragma once

#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>

#include <Eigen/Geometry>
#include <boost/make_shared.hpp>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "voxid/core/depth_view.h"

namespace voxid::test {

/// Table frame: origin on the table below the camera, x to the right, y forward, z up.
struct BoxOnTable {
  Eigen::Vector3d centre_m, size_m;
};
struct BallOnTable {
  Eigen::Vector3d centre_m;
  double radius_m;
};

struct TableScene {
  static constexpr int kWidth = 320, kHeight = 240;
  static constexpr double kFocal_px = 262.5, kCx_px = 159.5, kCy_px = 119.5;

  double height_m = 0.6;  ///< of the camera above the table
  double down_deg = 40;   ///< how far the camera looks down
  double turn_deg = 0;    ///< how far the camera has gone round the table's middle, counter-clockwise from above
  double table_half_m = 0.45, table_centre_y_m = 0.75;
  std::vector<BoxOnTable> boxes{{{-0.15, 0.70, 0.06}, {0.10, 0.08, 0.12}}};
  std::vector<BallOnTable> balls{{{0.15, 0.75, 0.06}, 0.06}};

  Eigen::Isometry3d tableFromCamera() const {
    const double c = std::cos(down_deg * M_PI / 180), s = std::sin(down_deg * M_PI / 180);
    Eigen::Matrix3d axes;  // rows: the table's axes in the camera's frame
    axes << 1, 0, 0, 0, -s, c, 0, -c, -s;
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = axes;
    pose.translation() = Eigen::Vector3d(0, 0, height_m);
    const Eigen::Translation3d middle(0, table_centre_y_m, 0);
    return middle * Eigen::AngleAxisd(turn_deg * M_PI / 180, Eigen::Vector3d::UnitZ()) * middle.inverse() * pose;
  }
  /// A point of the table frame, as the camera sees it.
  Eigen::Vector3d inCamera(const Eigen::Vector3d& point) const { return tableFromCamera().inverse() * point; }

  /// Row by row, millimetres, 0 where nothing is hit.
  std::vector<std::uint16_t> depth_mm() const {
    std::vector<std::uint16_t> depth(kWidth * kHeight);
    for (int v = 0; v < kHeight; ++v)
      for (int u = 0; u < kWidth; ++u) depth[v * kWidth + u] = depthAt(u, v);
    return depth;
  }

 private:
  static constexpr double kMiss = std::numeric_limits<double>::infinity();

  std::uint16_t depthAt(int u, int v) const {
    const Eigen::Vector3d ray((u - kCx_px) / kFocal_px, (v - kCy_px) / kFocal_px,
                              1);  // depth 1: the factor is the depth
    const Eigen::Isometry3d pose = tableFromCamera();
    const Eigen::Vector3d from = pose.translation(), along = pose.linear() * ray;
    double depth = hitTable(from, along);
    for (const BoxOnTable& box : boxes) depth = std::min(depth, hitBox(box, from, along));
    for (const BallOnTable& ball : balls) depth = std::min(depth, hitBall(ball, from, along));
    return std::isfinite(depth) ? static_cast<std::uint16_t>(std::lround(depth * 1000)) : 0;
  }

  double hitTable(const Eigen::Vector3d& from, const Eigen::Vector3d& along) const {
    if (along.z() >= 0) return kMiss;
    const double depth = -from.z() / along.z();
    const Eigen::Vector3d at = from + depth * along;
    const bool on = std::abs(at.x()) < table_half_m && std::abs(at.y() - table_centre_y_m) < table_half_m;
    return on ? depth : kMiss;
  }

  static double hitBox(const BoxOnTable& box, const Eigen::Vector3d& from, const Eigen::Vector3d& along) {
    const Eigen::Array3d a = (box.centre_m - box.size_m / 2 - from).array() / along.array();
    const Eigen::Array3d b = (box.centre_m + box.size_m / 2 - from).array() / along.array();
    const double enter = a.min(b).maxCoeff(), leave = a.max(b).minCoeff();
    return enter < leave && enter > 0 ? enter : kMiss;
  }

  static double hitBall(const BallOnTable& ball, const Eigen::Vector3d& from, const Eigen::Vector3d& along) {
    const Eigen::Vector3d to = from - ball.centre_m;
    const double a = along.squaredNorm(), half_b = to.dot(along), c = to.squaredNorm() - ball.radius_m * ball.radius_m;
    const double discriminant = half_b * half_b - a * c;
    return discriminant > 0 ? (-half_b - std::sqrt(discriminant)) / a : kMiss;
  }
};

inline sensor_msgs::ImagePtr imageOf(const std::vector<std::uint16_t>& depth_mm, const ros::Time& stamp) {
  const auto image = boost::make_shared<sensor_msgs::Image>();
  image->header.stamp = stamp;
  image->header.frame_id = "camera";
  image->width = TableScene::kWidth;
  image->height = TableScene::kHeight;
  image->encoding = "16UC1";
  image->step = image->width * 2;
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(depth_mm.data());
  image->data.assign(bytes, bytes + depth_mm.size() * 2);
  return image;
}

inline sensor_msgs::CameraInfoPtr infoOf(const ros::Time& stamp) {
  const auto info = boost::make_shared<sensor_msgs::CameraInfo>();
  info->header.stamp = stamp;
  info->header.frame_id = "camera";
  info->width = TableScene::kWidth;
  info->height = TableScene::kHeight;
  info->K = {TableScene::kFocal_px, 0, TableScene::kCx_px, 0, TableScene::kFocal_px, TableScene::kCy_px, 0, 0, 1};
  return info;
}

}  // namespace voxid::test
