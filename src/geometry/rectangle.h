// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "plan.h"

namespace voxid {

/// In the plan, micrometres.
struct Rectangle {
  double along_x = 1, along_y = 0;  // unit vector of the longer side
  double centre_x = 0, centre_y = 0;
  double length = 0, width = 0;
};

/// The smallest rectangle round a convex hull; it has a side on an edge of the hull. Areas are compared in whole square
/// micrometres.
Rectangle smallestRectangle(Span<const Point2> hull);

}  // namespace voxid
