// SPDX-License-Identifier: BSD-3-Clause
// Things and table as the simple solids that a planner's collision checks take.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "voxid/core/depth_view.h"
#include "voxid/core/span.h"
#include "voxid/geometry/scene.h"

namespace voxid {

enum class PrimitiveKind : std::uint8_t { Box = 1, Cylinder = 3 };  ///< numbers as in shape_msgs/SolidPrimitive
const char* nameOf(PrimitiveKind kind);                             ///< "box", "cylinder"

/// As a Cluster has it, in the camera's optical frame.
struct OrientedBox {
  Eigen::Vector3f centre_m{0, 0, 0};
  Eigen::Matrix3f axes = Eigen::Matrix3f::Identity();  ///< columns, right-handed
  Eigen::Vector3f size_m{0, 0, 0};                     ///< along the axes
};
inline OrientedBox boxOf(const Cluster& cluster) { return {cluster.box_centre_m, cluster.axes, cluster.extents_m}; }

/// A solid in the camera's optical frame.
struct Primitive {
  PrimitiveKind kind = PrimitiveKind::Box;
  Eigen::Vector3f centre_m{0, 0, 0};
  Eigen::Matrix3f axes = Eigen::Matrix3f::Identity();  ///< columns, right-handed; a cylinder's axis is the third
  Eigen::Vector3f size_m{0, 0, 0};                     ///< along the axes; of a cylinder diameter, diameter, length
  float misfit_mm = 0;  ///< mean distance of the visible points from its surface, each counted up to 10 mm
};

/// The box round the visible points, or a cylinder with a side of that box for its axis (upright or lying) where that
/// lies clearly nearer to the points. A cylinder reaches behind what is seen. `pixels` (row * width + column): of the
/// object; up to 256 of them, evenly spread, are looked at. Bounded, allocates nothing. Without pixels with depth: the
/// box.
Primitive primitiveOf(const DepthView& depth, Span<const std::uint32_t> pixels, const OrientedBox& box);

/// How far the visible points lie from a solid: as Primitive::misfit_mm, of the same pixels as primitiveOf's. 0 without
/// pixels with depth.
float misfitOf(const DepthView& depth, Span<const std::uint32_t> pixels, const Primitive& solid);

/// A slab under the table's visible part, kTableThickness_m thick with its top on the plane: the smallest box round the
/// outline, or a round one (cylinder) if that has less area. Size zero if there is no table.
Primitive primitiveOf(const Table& table);
constexpr float kTableThickness_m = 0.02f;  ///< a camera cannot see it

}  // namespace voxid
