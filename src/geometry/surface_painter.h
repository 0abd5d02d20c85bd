// SPDX-License-Identifier: BSD-3-Clause
// A model's surface as a camera would see it: a z-buffer, small and fast, for steps that draw a model anew.
#pragma once

#include <vector>

#include "pixel_grid.h"
#include "voxid/geometry/alignment.h"

namespace voxid {

class SurfacePainter {
 public:
  /// Replaces what was drawn before. Triangles that reach nearer than 50 mm (or 0.05 diagonals, if the pose's unit is
  /// the model's) to the camera's plane are left out.
  void draw(const ModelSurface& surface, const Placement& pose, const PixelGrid& grid);

  /// By cell of the grid; 0 where nothing is.
  const std::vector<float>& depth() const { return depth_; }
  bool covers(std::size_t cell) const { return depth_[cell] > 0; }
  /// Unit, in the camera's frame, towards the camera. Only where something is.
  Eigen::Vector3f normalAt(std::size_t cell, const PixelGrid& grid) const;
  /// The surface's vertices in the camera's frame.
  const std::vector<Eigen::Vector3f>& vertices() const { return vertices_; }

 private:
  void project(const PixelGrid& grid);
  void drawTriangle(std::uint32_t number, const PixelGrid& grid);

  struct ImagePoint {
    float x, y, inverse_depth;  ///< cells; 0: too near
  };
  const ModelSurface* surface_ = nullptr;
  std::vector<Eigen::Vector3f> vertices_;
  std::vector<ImagePoint> image_points_;
  std::vector<float> depth_;
  std::vector<std::uint32_t> triangles_;
  float nearest_ = 0;
};

}  // namespace voxid
