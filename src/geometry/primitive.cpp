// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/geometry/primitive.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "plane.h"
#include "rectangle.h"

namespace voxid {
namespace {

using Eigen::Matrix3f;
using Eigen::Vector2f;
using Eigen::Vector3f;

constexpr std::size_t kMostSamples = 256;
constexpr float kFar_m = 0.01f;
/// A cylinder's wall shows its whole width: its diameter is the wider side of the visible points, within a share.
constexpr float kLeastOfWidth = 0.85f, kMostOfWidth = 1.2f;
/// A cylinder must lie so much nearer, as it is the freer of the two.
constexpr std::int64_t kClearlyNearerPercent = 80;
constexpr std::int64_t kNoLimit = std::numeric_limits<std::int64_t>::max();

/// Visible points in the axes of a solid, from its centre, metres.
struct Samples {
  std::array<Vector3f, kMostSamples> points;
  std::size_t size = 0;
};

Samples samplesOf(const DepthView& depth, Span<const std::uint32_t> pixels, const Vector3f& centre_m,
                  const Matrix3f& axes) {
  Samples samples;
  const std::size_t count = std::min(pixels.size, kMostSamples);
  const auto width = static_cast<std::uint32_t>(depth.width_px);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t pixel = pixels[i * pixels.size / count];
    const int u = static_cast<int>(pixel % width), v = static_cast<int>(pixel / width);
    const std::int32_t depth_um = depth.depthUm(u, v);
    if (depth_um <= 0) continue;
    const PointUm p = backProject(depth.camera, u, v, depth_um);
    const Vector3f point_m =
        Vector3f(static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)) * 1e-6f;
    samples.points[samples.size++] = axes.transpose() * (point_m - centre_m);
  }
  return samples;
}

/// Sum over the samples, in whole micrometres, so that equal solids compare equal on every machine; no sum goes on
/// beyond `limit_um`.
template <typename Distance>
std::int64_t misfitUm(const Samples& samples, std::int64_t limit_um, Distance distance) {
  std::int64_t sum_um = 0;
  for (std::size_t i = 0; i < samples.size && sum_um < limit_um; ++i) {
    const float distance_m = std::min(std::abs(distance(samples.points[i])), kFar_m);
    sum_um += std::lround(static_cast<double>(distance_m) * 1e6);
  }
  return sum_um;
}

float meanMm(std::int64_t sum_um, const Samples& samples) {
  return samples.size == 0 ? 0 : static_cast<float>(sum_um) * 1e-3f / static_cast<float>(samples.size);
}

/// Distance from a box of any dimension with sides of 2 `half` round the origin; negative inside.
template <typename Vector>
float distanceToBox(const Vector& point, const Vector& half) {
  const Vector beyond = point.cwiseAbs() - half;
  return beyond.cwiseMax(0).norm() + std::min(beyond.maxCoeff(), 0.0f);
}

struct Circle {
  Vector2f centre_m{0, 0};
  float radius_m = 0;
};

/// A cylinder along one axis of the box, as long as the box.
struct Cylinder {
  int axis = 2;
  Circle circle;  ///< in the axes after it
  float half_length_m = 0;

  float distanceTo(const Vector3f& p) const {
    const Vector2f across(p[(axis + 1) % 3], p[(axis + 2) % 3]);
    const Vector2f from((across - circle.centre_m).norm(), p[axis]);
    return distanceToBox(from, Vector2f(circle.radius_m, half_length_m));
  }
};

/// The points seen along an axis, as a hull.
class Silhouette {
 public:
  Silhouette(const Samples& samples, int axis) {
    constexpr float kFarthest_um = 1e9f;  // differences stay below 2^31, whatever the intrinsics
    std::array<Point2, kMostSamples> points;
    for (std::size_t i = 0; i < samples.size; ++i) {
      const Vector3f um = (samples.points[i] * 1e6f).cwiseMin(kFarthest_um).cwiseMax(-kFarthest_um);
      points[i] = {static_cast<std::int32_t>(um[(axis + 1) % 3]), static_cast<std::int32_t>(um[(axis + 2) % 3])};
    }
    std::sort(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(samples.size),
              [](Point2 a, Point2 b) { return a.x != b.x ? a.x < b.x : a.y < b.y; });
    size_ = convexHull({points.data(), samples.size}, hull_.data());
  }

  /// visit(circle) for circles through three corners far apart.
  template <typename Visit>
  void visitCircles(Visit visit) const {
    for (std::size_t i = 0; i < size_ / 3; ++i)
      visit(through(corner(i), corner(i + size_ / 3), corner(i + 2 * size_ / 3)));
  }

 private:
  Vector2f corner(std::size_t i) const {
    return Vector2f(static_cast<float>(hull_[i].x), static_cast<float>(hull_[i].y)) * 1e-6f;
  }

  static Circle through(const Vector2f& a, const Vector2f& b, const Vector2f& c) {
    const Vector2f u = b - a, v = c - a;
    const float twice_area = u.x() * v.y() - u.y() * v.x();
    if (std::abs(twice_area) < 1e-9f) return {};
    const float uu = u.squaredNorm(), vv = v.squaredNorm();
    const Vector2f from_a = Vector2f(v.y() * uu - u.y() * vv, u.x() * vv - v.x() * uu) / (2 * twice_area);
    return {a + from_a, from_a.norm()};
  }

  std::array<Point2, 2 * kMostSamples> hull_;
  std::size_t size_ = 0;
};

Primitive asPrimitive(const OrientedBox& box, const Cylinder& cylinder) {
  const int a = (cylinder.axis + 1) % 3, b = (cylinder.axis + 2) % 3;
  Primitive primitive;
  primitive.kind = PrimitiveKind::Cylinder;
  primitive.axes << box.axes.col(a), box.axes.col(b), box.axes.col(cylinder.axis);
  primitive.centre_m =
      box.centre_m + box.axes.col(a) * cylinder.circle.centre_m.x() + box.axes.col(b) * cylinder.circle.centre_m.y();
  primitive.size_m = {2 * cylinder.circle.radius_m, 2 * cylinder.circle.radius_m, 2 * cylinder.half_length_m};
  return primitive;
}

}  // namespace

const char* nameOf(PrimitiveKind kind) { return kind == PrimitiveKind::Box ? "box" : "cylinder"; }

Primitive primitiveOf(const DepthView& depth, Span<const std::uint32_t> pixels, const OrientedBox& box) {
  const Samples samples = samplesOf(depth, pixels, box.centre_m, box.axes);
  const Vector3f half = box.size_m / 2;
  const std::int64_t box_um = misfitUm(samples, kNoLimit, [&](const Vector3f& p) { return distanceToBox(p, half); });
  Primitive best{PrimitiveKind::Box, box.centre_m, box.axes, box.size_m, 0};
  std::int64_t best_um = box_um, limit_um = box_um * kClearlyNearerPercent / 100;
  for (const int axis : {2, 0, 1}) {  // upright first: it wins a tie
    const float width_m = std::max(box.size_m[(axis + 1) % 3], box.size_m[(axis + 2) % 3]);
    Silhouette(samples, axis).visitCircles([&](const Circle& circle) {
      const float share = 2 * circle.radius_m / width_m;
      if (!(share >= kLeastOfWidth && share <= kMostOfWidth)) return;
      const Cylinder cylinder{axis, circle, half[axis]};
      const std::int64_t um = misfitUm(samples, limit_um, [&](const Vector3f& p) { return cylinder.distanceTo(p); });
      if (um >= limit_um) return;
      best = asPrimitive(box, cylinder);
      best_um = limit_um = um;
    });
  }
  best.misfit_mm = meanMm(best_um, samples);
  return best;
}

float misfitOf(const DepthView& depth, Span<const std::uint32_t> pixels, const Primitive& solid) {
  const Samples samples = samplesOf(depth, pixels, solid.centre_m, solid.axes);
  const Vector3f half = solid.size_m / 2;
  if (solid.kind == PrimitiveKind::Box)
    return meanMm(misfitUm(samples, kNoLimit, [&](const Vector3f& p) { return distanceToBox(p, half); }), samples);
  const Cylinder cylinder{2, {{0, 0}, half.x()}, half.z()};
  return meanMm(misfitUm(samples, kNoLimit, [&](const Vector3f& p) { return cylinder.distanceTo(p); }), samples);
}

namespace {

constexpr std::size_t kMostCorners = 512;  // of an outline; more are thinned evenly

/// The radius round the rectangle's centre that holds every corner of the hull, micrometres.
double radiusUm(Span<const Point2> hull, const Rectangle& r) {
  double square = 0;
  for (const Point2& p : hull) {
    const double x = p.x - r.centre_x, y = p.y - r.centre_y;
    square = std::max(square, x * x + y * y);
  }
  return std::sqrt(square);
}

}  // namespace

Primitive primitiveOf(const Table& table) {
  if (table.outline_m.size < 3) return {};
  Plan plan;
  plan.set({table.normal.cast<double>(), table.distance_m});
  std::array<Point2, kMostCorners> corners;
  std::array<Point2, 2 * kMostCorners> hull;
  const std::size_t count = std::min(table.outline_m.size, kMostCorners);
  for (std::size_t i = 0; i < count; ++i) {
    const Vector3f um = table.outline_m[i * table.outline_m.size / count] * 1e6f;
    corners[i] = plan.project(
        {static_cast<std::int32_t>(um.x()), static_cast<std::int32_t>(um.y()), static_cast<std::int32_t>(um.z())});
  }
  std::sort(corners.begin(), corners.begin() + static_cast<std::ptrdiff_t>(count),
            [](Point2 a, Point2 b) { return a.x != b.x ? a.x < b.x : a.y < b.y; });
  const Span<const Point2> outline{hull.data(), convexHull({corners.data(), count}, hull.data())};
  const Rectangle r = smallestRectangle(outline);
  const double radius_um = radiusUm(outline, r);
  constexpr double kPi = 3.14159265358979323846;
  const bool round = std::floor(kPi * radius_um * radius_um) < std::floor(r.length * r.width);
  Primitive slab;
  slab.kind = round ? PrimitiveKind::Cylinder : PrimitiveKind::Box;
  slab.centre_m = plan.lift(r.centre_x * 1e-6, r.centre_y * 1e-6, -kTableThickness_m / 2).cast<float>();
  slab.axes << plan.direction(r.along_x, r.along_y).cast<float>(), plan.direction(-r.along_y, r.along_x).cast<float>(),
      plan.axis(2).cast<float>();
  const double length_m = (round ? 2 * radius_um : r.length) * 1e-6, width_m = (round ? 2 * radius_um : r.width) * 1e-6;
  slab.size_m = Eigen::Vector3d(length_m, width_m, kTableThickness_m).cast<float>();
  return slab;
}

}  // namespace voxid
