// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/library/surface_points.h"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace voxid {
namespace {

using Eigen::Vector3d;

struct Corners {
  Vector3d a, b, c;

  double doubledArea() const { return (b - a).cross(c - a).norm(); }
};

Corners cornersOf(const Mesh& mesh, const Mesh::Triangle& triangle) {
  const auto corner = [&](int i) {
    const Mesh::Vertex& v = mesh.vertices[triangle[static_cast<std::size_t>(i)]];
    return Vector3d(v[0], v[1], v[2]);
  };
  return {corner(0), corner(1), corner(2)};
}

/// The area up to and with each triangle.
std::vector<double> areasSoFar(const Mesh& mesh) {
  std::vector<double> sums;
  sums.reserve(mesh.triangles.size());
  double sum = 0;
  for (const Mesh::Triangle& triangle : mesh.triangles) {
    sum += cornersOf(mesh, triangle).doubledArea();
    sums.push_back(sum);
  }
  return sums;
}

double fraction(double x) { return x - std::floor(x); }

/// The i-th place in a triangle: Roberts' R2 sequence, folded from the unit square, which leaves it even.
Vector3d placeIn(const Corners& t, int i) {
  constexpr double kPlastic = 1.32471795724474602596;  // the real root of x^3 = x + 1
  double u = fraction(i / kPlastic), v = fraction(i / (kPlastic * kPlastic));
  if (u + v > 1) {
    u = 1 - u;
    v = 1 - v;
  }
  return t.a + u * (t.b - t.a) + v * (t.c - t.a);
}

PointUm toImageFrame(const Vector3d& p, const MeshBox& box) {
  constexpr double kDiagonal_um = 1e6;
  const auto centre = box.centre();
  const Vector3d um = (p - Vector3d(centre[0], centre[1], centre[2])) * (kDiagonal_um / box.diagonal());
  const auto rounded = [](double x) { return static_cast<std::int32_t>(std::lround(x)); };
  return {rounded(um.x()), rounded(-um.y()), rounded(-um.z())};
}

}  // namespace

std::vector<PointUm> surfacePoints(const Mesh& mesh, int count) {
  const MeshBox box = boxOf(mesh);
  const std::vector<double> areas = areasSoFar(mesh);
  std::vector<PointUm> points;
  points.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    const double area = areas.back() * (i + 0.5) / count;
    const auto found = std::lower_bound(areas.begin(), areas.end(), area);
    const Mesh::Triangle& triangle = mesh.triangles[static_cast<std::size_t>(found - areas.begin())];
    points.push_back(toImageFrame(placeIn(cornersOf(mesh, triangle), i), box));
  }
  return points;
}

}  // namespace voxid
