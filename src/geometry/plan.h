// SPDX-License-Identifier: BSD-3-Clause
// The table seen from above, in integers.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "plane.h"
#include "voxid/core/depth_view.h"
#include "voxid/core/span.h"

namespace voxid {

struct Point2 {
  std::int32_t x, y;
};

/// Convex hull of points sorted by x, then y; counter-clockwise from the first point, no three in a line. `hull` has
/// room for twice the points. Returns the number of vertices.
std::size_t convexHull(Span<const Point2> sorted, Point2* hull);

/// Directions of the pixels: point = depth times (x, y, 1), in 2^-20.
struct Rays {
  std::vector<std::int32_t> x_q20, y_q20;

  void reserve(int width_px, int height_px);
  void fill(const Camera& camera, int width_px, int height_px);
  PointUm point(int u, int v, std::int32_t depth_um) const {
    return {static_cast<std::int32_t>((static_cast<std::int64_t>(depth_um) * x_q20[static_cast<std::size_t>(u)]) >> 20),
            static_cast<std::int32_t>((static_cast<std::int64_t>(depth_um) * y_q20[static_cast<std::size_t>(v)]) >> 20),
            depth_um};
  }
};

/// Right-handed axes with the third along the table's normal; the origin is the camera's foot on the table.
class Plan {
 public:
  void set(const MetricPlane& table);

  Point2 project(const PointUm& p) const { return {along(axis_q20_[0], p), along(axis_q20_[1], p)}; }
  /// A unit vector of the plan: x, y, or up, in the camera's frame.
  const Eigen::Vector3d& axis(int i) const { return axis_[i]; }
  std::int32_t distanceUm() const { return distance_um_; }
  std::int32_t heightUm(const PointUm& p) const { return along(axis_q20_[2], p) + distance_um_; }
  Eigen::Vector3d direction(double x, double y) const { return x * axis_[0] + y * axis_[1]; }
  /// The point at (x, y) in the plan, `height` above the table; all in metres.
  Eigen::Vector3d lift(double x_m, double y_m, double height_m) const;

 private:
  using AxisQ20 = Eigen::Matrix<std::int64_t, 3, 1>;
  static std::int32_t along(const AxisQ20& axis, const PointUm& p) {
    return static_cast<std::int32_t>((axis[0] * p.x + axis[1] * p.y + axis[2] * p.z) >> 20);
  }

  Eigen::Vector3d axis_[3];
  AxisQ20 axis_q20_[3];
  std::int32_t distance_um_ = 0;
};

/// Points in the plan, one after the other.
struct PlacedPoints {
  std::vector<std::int32_t> x_um, y_um, height_um;  ///< as long as they ever had to be
  std::size_t count = 0;

  void reserve(std::size_t most);
  /// No points, and room for some.
  void clear(std::size_t room);
};

/// Places many pixels in the plan at a time. In the plan a point is its depth times a sum of a term of its column and
/// one of its row.
class PlanRays {
 public:
  void reserve(int width_px, int height_px);
  void fill(const Rays& rays, const Plan& plan);
  /// Appends the pixels (u, v) to (u + count - 1, v), which must have depth; there must be room.
  void place(const std::int32_t* inverse, int u, int v, int count, PlacedPoints& placed) const;
  /// Their heights above the table, micrometres, only.
  void heights(const std::int32_t* inverse, int u, int v, int count, std::int32_t* heights_um) const;

 private:
  std::vector<float> columns_[3], rows_[3];
  float distance_um_ = 0;
};

/// The convex hull of the table's pixels. A plane's homography keeps hulls, so it is found in the image.
class Outline {
 public:
  void reserve(int height_px);

  /// False if the pixels within `tolerance` of the plane span no area.
  bool fill(const InverseDepth& inverse, const PlaneSums& sums, std::int32_t tolerance, const Rays& rays,
            const Plan& plan);

  bool contains(Point2 plan_um, std::int32_t margin_um) const;
  Span<const Eigen::Vector3f> points_m() const { return {points_m_.data(), points_m_.size()}; }

 private:
  struct Edge {
    std::int64_t inward_x_q15, inward_y_q15, offset_q15;
  };
  void collectRowEnds(const InverseDepth& inverse, const PlaneSums& sums, std::int32_t tolerance);
  void addEdges(const std::vector<Point2>& corners);

  std::vector<Point2> ends_, hull_, corners_;
  std::vector<Edge> edges_;
  std::vector<Eigen::Vector3f> points_m_;
};

}  // namespace voxid
