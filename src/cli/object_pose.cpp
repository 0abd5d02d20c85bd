// SPDX-License-Identifier: BSD-3-Clause
#include "object_pose.h"

#include <Eigen/Geometry>
#include <cmath>

#include "../geometry/surface_painter.h"

namespace voxid::cli {
namespace {

Json rounded(double x, double digits) { return std::round(x * digits) / digits; }

template <typename Vector>
Json listOf(const Vector& values, double digits) {
  Json list = Json::array();
  for (int i = 0; i < values.size(); ++i) list.push_back(rounded(static_cast<double>(values(i)), digits));
  return list;
}

/// Every pixel of the image.
PixelGrid gridOf(const DepthView& depth) {
  constexpr float kPixel = 1 / 65536.0f;
  PixelGrid grid;
  grid.width = depth.width_px;
  grid.height = depth.height_px;
  grid.fx = kPixel * static_cast<float>(depth.camera.fx_q16);
  grid.fy = kPixel * static_cast<float>(depth.camera.fy_q16);
  grid.cx = kPixel * static_cast<float>(depth.camera.cx_q16);
  grid.cy = kPixel * static_cast<float>(depth.camera.cy_q16);
  return grid;
}

/// Of a model's pixel: whether one beside it is not the model's, or far behind.
bool isOutline(const std::vector<float>& drawn, const PixelGrid& grid, std::size_t cell) {
  constexpr float kStepMm = 15;
  const int u = grid.columnOf(cell), v = grid.rowOf(cell);
  const auto ends = [&](int x, int y) {
    if (!grid.contains(x, y)) return true;
    const float beside = drawn[grid.at(x, y)];
    return beside <= 0 || beside > drawn[cell] + kStepMm;
  };
  return ends(u - 1, v) || ends(u + 1, v) || ends(u, v - 1) || ends(u, v + 1);
}

bool isHidden(float seen_mm, float drawn_mm) { return seen_mm > 0 && seen_mm < drawn_mm - 15; }

}  // namespace

Json toJson(const ObjectPose& pose) {
  const Alignment& a = pose.alignment;
  if (!a.found) return nullptr;
  Json json;
  json["model"] = pose.model;
  json["rotation"] = listOf(Eigen::Quaternionf(a.pose.rotation).normalized().coeffs(), 1e6);
  json["translation_mm"] = listOf(a.pose.translation, 1e2);
  json["scale_mm"] = rounded(static_cast<double>(a.pose.scale), 1e2);
  json["fit_mm"] = rounded(static_cast<double>(a.fit_mm), 1e2);
  json["misfit"] = rounded(static_cast<double>(a.misfit), 1e4);
  json["explained"] = rounded(static_cast<double>(a.explained), 1e4);
  json["free_axis"] = a.rotation_known ? Json(nullptr) : listOf(a.free_axis, 1e6);
  json["covariance"] = listOf(PoseCovariance(a.covariance), 1e9);
  return json;
}

void drawPose(const DepthView& depth, const ObjectPose& pose, const cv::Scalar& colour, cv::Mat& picture) {
  if (!pose.alignment.found) return;
  const PixelGrid grid = gridOf(depth);
  SurfacePainter painter;
  painter.draw(pose.shelved->model.surface(), pose.alignment.pose, grid);
  for (std::size_t cell = 0; cell < grid.size(); ++cell) {
    if (!painter.covers(cell)) continue;
    const int u = grid.columnOf(cell), v = grid.rowOf(cell);
    if (isHidden(static_cast<float>(depth.depthUm(u, v)) / 1000, painter.depth()[cell])) continue;
    const float facing = std::abs(painter.normalAt(cell, grid).dot(grid.ray(cell).normalized()));
    const double light = isOutline(painter.depth(), grid, cell) ? 1.0 : 0.2 + 0.7 * static_cast<double>(facing);
    auto& pixel = picture.at<cv::Vec3b>(v, u);
    for (int i = 0; i < 3; ++i) pixel[i] = cv::saturate_cast<unsigned char>(light * colour[i]);
  }
}

}  // namespace voxid::cli
