// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/library/views.h"

#include <Eigen/Geometry>
#include <cmath>

namespace voxid {
namespace {

using Eigen::Vector3d;

/// Twelve corners: the cyclic permutations of (0, +-1, +-golden ratio), so only square roots are needed and every
/// machine rounds alike.
std::array<Vector3d, 12> icosahedronCorners() {
  const double golden = (1 + std::sqrt(5.0)) / 2;
  std::array<Vector3d, 12> corners;
  int n = 0;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double one : {-1.0, 1.0}) {
      for (const double far : {-golden, golden}) {
        Vector3d corner = Vector3d::Zero();
        corner[(axis + 1) % 3] = one;
        corner[(axis + 2) % 3] = far;
        corners[n++] = corner.normalized();
      }
    }
  }
  return corners;
}

/// Neighbouring corners of a unit icosahedron are 1.051 apart, the next nearest 1.701.
bool neighbours(const Vector3d& a, const Vector3d& b) { return (a - b).squaredNorm() < 1.5; }

void toInt16(const Vector3d& unit, std::int16_t (&out)[3]) {
  for (int i = 0; i < 3; ++i) out[i] = static_cast<std::int16_t>(std::lround(unit[i] * 32767));
}

format::Direction directionOf(const Vector3d& to_camera) {
  const Vector3d axis = std::abs(to_camera.y()) < 0.95 ? Vector3d::UnitY() : Vector3d::UnitZ();
  const Vector3d up = (axis - axis.dot(to_camera) * to_camera).normalized();
  format::Direction direction{};
  toInt16(to_camera, direction.to_camera);
  toInt16(up, direction.up);
  return direction;
}

Vector3d centreOf(const Vector3d& a, const Vector3d& b, const Vector3d& c) { return (a + b + c).normalized(); }

void addFace(const Vector3d& a, const Vector3d& b, const Vector3d& c, format::Direction* out) {
  const Vector3d ab = (a + b).normalized(), bc = (b + c).normalized(), ca = (c + a).normalized();
  out[0] = directionOf(centreOf(ab, bc, ca));
  out[1] = directionOf(centreOf(a, ab, ca));
  out[2] = directionOf(centreOf(b, bc, ab));
  out[3] = directionOf(centreOf(c, ca, bc));
}

Directions makeDirections() {
  const auto corners = icosahedronCorners();
  Directions directions{};
  int n = 0;
  for (int i = 0; i < 12; ++i) {
    for (int j = i + 1; j < 12; ++j) {
      for (int k = j + 1; k < 12; ++k) {
        const bool face = neighbours(corners[i], corners[j]) && neighbours(corners[j], corners[k]) &&
                          neighbours(corners[k], corners[i]);
        if (!face) continue;
        addFace(corners[i], corners[j], corners[k], &directions[n]);
        n += 4;
      }
    }
  }
  return directions;
}

}  // namespace

const Directions& viewDirections() {
  static const Directions directions = makeDirections();
  return directions;
}

}  // namespace voxid
