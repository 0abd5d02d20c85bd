// SPDX-License-Identifier: BSD-3-Clause
// What rests is the same solid in every frame: a planner's collision scene does not tremble with the sensor's noise.
#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "voxid/core/depth_view.h"
#include "voxid/core/span.h"
#include "voxid/geometry/primitive.h"

namespace voxid {

/// Where the box round what is seen of a thing lies, and how large it is.
struct VisibleBox {
  static constexpr double kRest_m = 0.015;  ///< the centre of a resting thing's box wanders by less with equal extents

  Eigen::Vector3d centre_m{0, 0, 0}, extents_m{0, 0, 0};

  /// Whether a thing that was seen as this and is seen as `other` may not have moved. What is cut off at one end moves
  /// the centre by half of what the box loses.
  bool holds(const VisibleBox& other) const;
};

/// The solid of one object that is seen again and again. It stays until the object has moved or a solid that is found
/// anew lies clearly nearer to the visible points: so a hand before a thing does not cut its solid, and what lies
/// between box and cylinder stays the one that it was.
class SteadySolid {
 public:
  void clear() { found_.reset(); }

  /// The object's solid in the camera's frame. `rest_from_camera`: into a frame that does not move when the camera
  /// does. `looks_for_better`: without, primitiveOf is called only where the solid no longer fits. No allocation.
  Primitive see(const DepthView& depth, Span<const std::uint32_t> pixels, const OrientedBox& box,
                const Eigen::Isometry3d& rest_from_camera, bool looks_for_better);

 private:
  /// In the camera's frame of then.
  struct Found {
    Primitive solid;
    VisibleBox seen;
    Eigen::Isometry3d rest_from_camera;
  };

  std::optional<Found> found_;
};

}  // namespace voxid
