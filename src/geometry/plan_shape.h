// SPDX-License-Identifier: BSD-3-Clause
// What a piece looks like from above.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>

#include "plan.h"

namespace voxid {

/// Directions in the plan: away from the camera's foot through a piece, and to the right of that.
struct ViewerAxes {
  std::int64_t away_x_q15, away_y_q15;
};
ViewerAxes axesTowards(const PlacedPoints& points);

struct Extent {
  std::int64_t low = std::numeric_limits<std::int32_t>::max(), high = std::numeric_limits<std::int32_t>::min();

  void add(std::int64_t x) {
    low = std::min(low, x);
    high = std::max(high, x);
  }
  std::int64_t size() const { return high - low; }
};
std::int64_t overlapOf(const Extent& a, const Extent& b);

/// A piece from above: its extents, and how much farther its middle lies than its ends (positive: hollow to the
/// viewer).
struct PlanShape {
  Extent across, away;
  std::int64_t sagitta_um = 0;

  bool isWiderThan(std::int64_t most_um) const { return across.size() > most_um || away.size() > most_um; }
};

/// Turns the points: their x and y are across and away then.
PlanShape shapeOf(const ViewerAxes& axes, PlacedPoints& points);
/// Of their places; not of what their ends tell.
PlanShape united(const PlanShape& a, const PlanShape& b);
bool isWithin(const PlanShape& inner, const PlanShape& outer);
/// How much higher the middle of turned points lies than what is around it.
std::int64_t bulgeOf(const PlanShape& shape, const PlacedPoints& points);

/// In the plan, millimetres.
struct Circle {
  Eigen::Vector2d centre;
  double radius = 0;
  double distance = 0;  ///< of the centre from the camera
};
/// Whether both go round one upright axis. The camera sees better how far to the side an axis stands than how far away.
bool areCoaxial(const Circle& a, const Circle& b);

/// The circle of which a piece's front, as the camera sees it, is the nearer half, and that of which its back, hollow,
/// is the farther half, or most of these. What was turned on a lathe or a wheel, and stands, has one round its axis.
struct Arcs {
  std::optional<Circle> front, back;
};
/// Turns the points.
Arcs arcsOf(double camera_height_m, PlacedPoints& points);
/// Whether one of each are.
bool areCoaxial(const Arcs& a, const Arcs& b);

}  // namespace voxid
