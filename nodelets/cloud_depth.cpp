// SPDX-License-Identifier: BSD-3-Clause
#include "cloud_depth.h"

#include <sensor_msgs/distortion_models.h>
#include <sensor_msgs/image_encodings.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>

namespace voxid {
namespace {

constexpr std::uint32_t kSamplesASide = 64;  // points that the camera is found from
constexpr double kMostResidual_px = 1;       // of a camera with the distortion that drivers leave in
constexpr double kUsualFocal_px = 525;       // of 640 columns, where no point says more

/// Sums of a straight line's least squares.
struct LineSums {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;

  void add(double x_new, double y_new) {
    n += 1, x += x_new, y += y_new;
    xx += x_new * x_new, xy += x_new * y_new, yy += y_new * y_new;
  }
  double spread() const { return n * xx - x * x; }
  double slope() const { return (n * xy - x * y) / spread(); }
  double residual(double slope) const {
    const double square = (yy - y * y / n) - slope * (xy - x * y / n);
    return std::sqrt(std::max(0.0, square) / n);
  }
};

Status checkShape(const sensor_msgs::PointCloud2& cloud) {
  if (cloud.height < 2 || cloud.width < 2)
    return Status::badUse("the cloud is not organised (" + std::to_string(cloud.width) + " x " +
                          std::to_string(cloud.height) +
                          " points), expected rows and columns as the camera saw them: remap points to the driver's "
                          "organised cloud, or give the depth image itself");
  return {};
}

}  // namespace

Status CloudDepth::findCamera(const sensor_msgs::PointCloud2& cloud, const CloudFields& fields) {
  LineSums columns, rows;
  const std::uint32_t du = std::max(1u, cloud.width / kSamplesASide), dv = std::max(1u, cloud.height / kSamplesASide);
  for (std::uint32_t v = 0; v < cloud.height; v += dv) {
    for (std::uint32_t u = 0; u < cloud.width; u += du) {
      const float x = fields.x(u, v), y = fields.y(u, v), z = fields.z(u, v);
      if (!std::isfinite(x) || !std::isfinite(y) || !std::isfinite(z) || z <= 0) continue;
      columns.add(x / z, u);
      rows.add(y / z, v);
    }
  }
  const bool known = width_ == cloud.width && height_ == cloud.height;
  if (columns.n < 16 || columns.spread() < 1e-9 || rows.spread() < 1e-9) {
    if (known) return {};
    const double focal_px = kUsualFocal_px * cloud.width / 640;
    column_ = {focal_px, (cloud.width - 1) / 2.0, 0};
    row_ = {focal_px, (cloud.height - 1) / 2.0, 0};
    return {};  // and the next cloud tells
  }
  const double fx = columns.slope(), fy = rows.slope();
  column_ = {fx, (columns.y - fx * columns.x) / columns.n, columns.residual(fx)};
  row_ = {fy, (rows.y - fy * rows.x) / rows.n, rows.residual(fy)};
  width_ = cloud.width;
  height_ = cloud.height;
  if (fx > 0 && fy > 0 && column_.residual_px <= kMostResidual_px && row_.residual_px <= kMostResidual_px) return {};
  width_ = height_ = 0;
  return Status::badUse(
      "the cloud's points are not where a pinhole camera sees them: expected the optical frame (x right, "
      "y down, z forward) and the camera's own rows and columns");
}

Status CloudDepth::convert(const sensor_msgs::PointCloud2& cloud, sensor_msgs::Image* image,
                           sensor_msgs::CameraInfo* info) {
  if (const Status shape = checkShape(cloud); !shape.ok()) return shape;
  const Result<CloudFields> fields = CloudFields::of(cloud);
  if (!fields.ok()) return fields.status;
  if (const Status camera = findCamera(cloud, fields.value); !camera.ok()) return camera;
  image->header = info->header = cloud.header;
  image->width = info->width = cloud.width;
  image->height = info->height = cloud.height;
  image->encoding = sensor_msgs::image_encodings::TYPE_32FC1;
  image->step = cloud.width * 4;
  image->is_bigendian = 0;
  image->data.resize(std::size_t{image->step} * cloud.height);
  for (std::uint32_t v = 0; v < cloud.height; ++v) {
    for (std::uint32_t u = 0; u < cloud.width; ++u) {
      const float z = fields.value.z(u, v);
      std::memcpy(&image->data[std::size_t{image->step} * v + std::size_t{4} * u], &z, 4);
    }
  }
  info->distortion_model = sensor_msgs::distortion_models::PLUMB_BOB;
  info->D.assign(5, 0.0);
  info->K = {column_.focal_px, 0, column_.centre_px, 0, row_.focal_px, row_.centre_px, 0, 0, 1};
  info->R = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  info->P = {column_.focal_px, 0, column_.centre_px, 0, 0, row_.focal_px, row_.centre_px, 0, 0, 0, 1, 0};
  return {};
}

}  // namespace voxid
