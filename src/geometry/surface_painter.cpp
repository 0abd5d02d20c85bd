// SPDX-License-Identifier: BSD-3-Clause
#include "surface_painter.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "../core/vectorised.h"

namespace voxid {
namespace {

/// Of a number that is not negative; std::ceil is a call where the processor's newer instructions are not presumed.
int roundedUp(float x) {
  const int below = static_cast<int>(x);
  return below + (static_cast<float>(below) < x ? 1 : 0);
}

constexpr int kLanes = 8;

/// A triangle as it is drawn into cells: the shares of its second and third corner are linear in the image, and so is
/// the inverse depth.
struct Facet {
  int left, top, right, bottom;
  float x, y;  ///< of the first corner
  float b_dx, b_dy, c_dx, c_dy;
  float inverse, b_inverse, c_inverse;  ///< at the first corner, and what the others have more
  std::uint32_t number;
};

/// Cells in groups of kLanes, so that a compiler makes one of eight; those of a group that lie outside stay as they
/// are. Both arrays go on for kLanes - 1 beyond the last cell.
VOXID_VECTORISED void paint(const Facet f, int width, float* __restrict inverse_depth,
                            std::uint32_t* __restrict triangles) {
  for (int row = f.top; row <= f.bottom; ++row) {
    const float y = static_cast<float>(row) - f.y, b_y = f.b_dy * y, c_y = f.c_dy * y;
    for (int first = f.left; first <= f.right; first += kLanes) {
      float* const nearest = inverse_depth + row * width + first;
      std::uint32_t* const owner = triangles + row * width + first;
      for (int i = 0; i < kLanes; ++i) {
        const float x = static_cast<float>(first + i) - f.x;
        const float of_b = f.b_dx * x + b_y, of_c = f.c_dx * x + c_y;
        const float inverse = f.inverse + of_b * f.b_inverse + of_c * f.c_inverse;
        const std::uint32_t in = (of_b >= 0 ? ~0u : 0u) & (of_c >= 0 ? ~0u : 0u) & (of_b + of_c <= 1 ? ~0u : 0u) &
                                 (first + i <= f.right ? ~0u : 0u) & (inverse > nearest[i] ? ~0u : 0u);
        nearest[i] = in != 0 ? inverse : nearest[i];
        owner[i] = (f.number & in) | (owner[i] & ~in);
      }
    }
  }
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
  depth_.assign(grid.size() + kLanes - 1, 0);  // holds inverse depths until all is drawn
  triangles_.resize(grid.size() + kLanes - 1);
  for (std::uint32_t i = 0; i < surface.triangles.size(); ++i) drawTriangle(i, grid);
  depth_.resize(grid.size());
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
  const Facet facet{left,
                    top,
                    right,
                    bottom,
                    a.x,
                    a.y,
                    (c.y - a.y) * per_area,
                    (a.x - c.x) * per_area,
                    (a.y - b.y) * per_area,
                    (b.x - a.x) * per_area,
                    a.inverse_depth,
                    b.inverse_depth - a.inverse_depth,
                    c.inverse_depth - a.inverse_depth,
                    number};
  paint(facet, grid.width, depth_.data(), triangles_.data());
}

Vector3f SurfacePainter::normalAt(std::size_t cell, const PixelGrid& grid) const {
  const auto& corners = surface_->triangles[triangles_[cell]];
  const Vector3f& a = vertices_[corners[0]];
  const Vector3f normal = (vertices_[corners[1]] - a).cross(vertices_[corners[2]] - a).normalized();
  return normal.dot(grid.ray(cell)) > 0 ? Vector3f(-normal) : normal;
}

}  // namespace voxid
