// SPDX-License-Identifier: BSD-3-Clause
#include "surface_painter.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace voxid {
namespace {

/// Of a number that is not negative; std::ceil is a call where the processor's newer instructions are not presumed.
int roundedUp(float x) {
  const int below = static_cast<int>(x);
  return below + (static_cast<float>(below) < x ? 1 : 0);
}

}  // namespace

using Eigen::Vector3f;

void SurfacePainter::draw(const ModelSurface& surface, const Placement& pose, const PixelGrid& grid) {
  surface_ = &surface;
  nearest_ = 0.05f * pose.scale;
  const Eigen::Matrix3f turn_and_scale = pose.scale * pose.rotation;
  vertices_.resize(surface.vertices.size());
  for (std::size_t i = 0; i < vertices_.size(); ++i)
    vertices_[i] = turn_and_scale * surface.vertices[i] + pose.translation;
  project(grid);
  depth_.assign(grid.size(), 0);  // holds inverse depths until all is drawn
  triangles_.resize(grid.size());
  for (std::uint32_t i = 0; i < surface.triangles.size(); ++i) drawTriangle(i, grid);
  for (float& depth : depth_) depth = depth > 0 ? 1 / depth : 0;
}

void SurfacePainter::project(const PixelGrid& grid) {
  image_points_.resize(vertices_.size());
  for (std::size_t i = 0; i < vertices_.size(); ++i) {
    const Vector3f& p = vertices_[i];
    const float inverse = p.z() > nearest_ ? 1 / p.z() : 0;
    image_points_[i] = {grid.fx * p.x() * inverse + grid.cx, grid.fy * p.y() * inverse + grid.cy, inverse};
  }
}

void SurfacePainter::drawTriangle(std::uint32_t number, const PixelGrid& grid) {
  const auto& corners = surface_->triangles[number];
  const ImagePoint &a = image_points_[corners[0]], &b = image_points_[corners[1]], &c = image_points_[corners[2]];
  if (a.inverse_depth <= 0 || b.inverse_depth <= 0 || c.inverse_depth <= 0) return;
  const int left = roundedUp(std::max(0.0f, std::min({a.x, b.x, c.x})));
  const int top = roundedUp(std::max(0.0f, std::min({a.y, b.y, c.y})));
  const int right = static_cast<int>(std::min(static_cast<float>(grid.width - 1), std::max({a.x, b.x, c.x})));
  const int bottom = static_cast<int>(std::min(static_cast<float>(grid.height - 1), std::max({a.y, b.y, c.y})));
  if (left > right || top > bottom) return;  // most: between the cells' centres, or outside
  const float area = (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y);
  if (std::abs(area) < 1e-9f) return;
  const float per_area = 1 / area;
  // Barycentric shares of b and c are linear in the image, and so is the inverse depth.
  const float b_dx = (c.y - a.y) * per_area, b_dy = (a.x - c.x) * per_area;
  const float c_dx = (a.y - b.y) * per_area, c_dy = (b.x - a.x) * per_area;
  for (int row = top; row <= bottom; ++row) {
    const float y = static_cast<float>(row) - a.y;
    for (int column = left; column <= right; ++column) {
      const float x = static_cast<float>(column) - a.x;
      const float of_b = b_dx * x + b_dy * y, of_c = c_dx * x + c_dy * y;
      if (of_b < 0 || of_c < 0 || of_b + of_c > 1) continue;
      const float inverse =
          a.inverse_depth + of_b * (b.inverse_depth - a.inverse_depth) + of_c * (c.inverse_depth - a.inverse_depth);
      const std::size_t cell = grid.at(column, row);
      if (inverse <= depth_[cell]) continue;
      depth_[cell] = inverse;
      triangles_[cell] = number;
    }
  }
}

Vector3f SurfacePainter::normalAt(std::size_t cell, const PixelGrid& grid) const {
  const auto& corners = surface_->triangles[triangles_[cell]];
  const Vector3f& a = vertices_[corners[0]];
  const Vector3f normal = (vertices_[corners[1]] - a).cross(vertices_[corners[2]] - a).normalized();
  return normal.dot(grid.ray(cell)) > 0 ? Vector3f(-normal) : normal;
}

}  // namespace voxid
