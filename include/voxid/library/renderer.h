// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <vector>

#include "voxid/core/depth_view.h"
#include "voxid/core/span.h"
#include "voxid/geometry/placement.h"
#include "voxid/geometry/scene.h"
#include "voxid/library/mesh.h"

namespace voxid {

/// Centres a mesh on its box and makes the box's diagonal 1.
Placement unitPlacement(const Mesh& mesh);

/// Image size and pinhole intrinsics.
struct Imager {
  int width_px = 640, height_px = 480;
  Camera camera = Camera::fromPixels(525, 525, 319.5, 239.5);
};

/// What a ray met.
struct Hit {
  float depth_mm = 0;        ///< along the optical axis; 0 = nothing
  float cosine = 0;          ///< between ray and surface normal, without sign: 1 = seen frontally, 0 = grazing
  std::uint16_t object = 0;  ///< 1 + the number of the mesh in its scene; 0 = nothing
};

/// Meshes to cast rays at (Embree, pinned to one thread and one instruction set, so that one processor answers as
/// another). Both sides of a triangle are solid; surfaces need not be closed. Not to be shared between threads.
class RayScene {
 public:
  RayScene();
  ~RayScene();
  RayScene(RayScene&&) noexcept;
  RayScene& operator=(RayScene&&) noexcept;

  /// Adds a mesh at its place in the scene; the number of the mesh.
  int add(const Mesh& mesh, const Placement& placement);
  /// After the last add(), before the first ray.
  void commit();

  /// The first surface that the ray through each image point (pixels) meets. `pose` takes scene to camera, millimetres.
  /// Neighbouring points go in one call, and fast.
  void cast(const Camera& camera, const Placement& pose, Span<const Eigen::Vector2f> points_px, Span<Hit> hits) const;
  /// Whether a surface lies between each point and a common one, all in the camera's frame, millimetres.
  void findBlocked(const Placement& pose, Span<const Eigen::Vector3f> from_mm, const Eigen::Vector3f& to_mm,
                   Span<std::uint8_t> blocked) const;
  /// Pixels that the scene can fall on; the whole image if a part of the scene lies behind the camera.
  PixelBox projectedBox(const Imager& imager, const Placement& pose) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Every pixel's hit, through pixel centres: the view of an ideal sensor.
struct RenderedView {
  int width_px = 0, height_px = 0;
  std::vector<Hit> hits;  ///< row-major
};
RenderedView render(const RayScene& scene, const Imager& imager, const Placement& pose);

}  // namespace voxid
