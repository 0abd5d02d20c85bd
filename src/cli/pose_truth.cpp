// SPDX-License-Identifier: BSD-3-Clause
#include "pose_truth.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "../library/random.h"

namespace voxid::cli {
namespace {

using Eigen::Matrix3f;
using Eigen::Vector3f;

/// Evenly over the sphere: a point of the ball, whose length does not matter.
format::Direction drawDirection(Random& random) {
  Vector3f d(0, 0, 1);
  for (int tries = 0; tries < 64; ++tries) {
    const Vector3f drawn(random.between(-1, 1), random.between(-1, 1), random.between(-1, 1));
    if (drawn.squaredNorm() > 1 || drawn.squaredNorm() < 0.1f) continue;
    d = drawn.normalized();
    break;
  }
  const Vector3f axis = std::abs(d.y()) < 0.95f ? Vector3f::UnitY() : Vector3f::UnitZ();
  const Vector3f up = (axis - axis.dot(d) * d).normalized();
  format::Direction direction{};
  for (int i = 0; i < 3; ++i) {
    direction.to_camera[i] = static_cast<std::int16_t>(std::lround(d[i] * 32767));
    direction.up[i] = static_cast<std::int16_t>(std::lround(up[i] * 32767));
  }
  return direction;
}

double angleBetween(const Matrix3f& a, const Matrix3f& b) {
  // Of the chord, which is exact for small angles where the cosine is not.
  const double chord = std::min(1.0, static_cast<double>((a - b).norm()) / std::sqrt(8.0));
  return 2 * std::asin(chord) * 180 / 3.14159265358979;
}

/// The pose that looks the same and is turned least from what was found.
Placement nearestAlike(const Matrix3f& found, Placement truth, const Symmetry& symmetry) {
  const Matrix3f as_placed = truth.rotation;
  double least = 360;
  for (const Matrix3f& turn : turnsOf(symmetry)) {
    const double angle = angleBetween(found, as_placed * turn);
    if (angle >= least) continue;
    least = angle;
    truth.rotation = as_placed * turn;
  }
  return truth;
}

double addS(const Placement& found, const Placement& truth, const ModelSurface& surface) {
  const SurfaceSamples moved(surface, 500, 0.37f), still(surface, 8000);
  double sum = 0;
  for (const Vector3f& p : moved.points()) {
    const Vector3f in_true_frame = truth.rotation.transpose() * (found(p) - truth.translation) / truth.scale;
    sum += still.distanceTo(in_true_frame) - still.distanceTo(p);
  }
  return sum / static_cast<double>(std::max<std::size_t>(1, moved.points().size()));
}

}  // namespace

PosedView drawPosedView(const Mesh& mesh, std::uint64_t seed) {
  constexpr std::size_t kEnoughPixels = 400;
  RayScene scene;
  scene.add(mesh, unitPlacement(mesh));
  scene.commit();
  Random random(seed);
  const Imager imager;
  PosedView best;
  for (int tries = 0; tries < 8 && best.pixels.size() < kEnoughPixels; ++tries) {
    PosedView view;
    const format::Direction direction = drawDirection(random);
    view.pose = drawPose(direction, imager, ViewRange(), random.next());
    view.image = observe(scene, imager, view.pose, SensorParams(), random.next());
    view.pixels = view.image.setPixels();
    if (view.pixels.size() >= best.pixels.size()) best = std::move(view);
  }
  return best;
}

bool PoseError::strict() const {
  return (rotation_deg <= 5 || add_s < 0.02) && translation_mm <= 5 && std::abs(scale_percent) <= 3;
}

double normalisedError(const Alignment& found, const Placement& truth, const Symmetry& symmetry) {
  const Placement alike = nearestAlike(found.pose.rotation, truth, symmetry);
  const Eigen::AngleAxisf turn(Matrix3f(alike.rotation * found.pose.rotation.transpose()));
  Eigen::Matrix<double, kPoseUnknowns, 1> error;
  error << (alike.translation - found.pose.translation).cast<double>(), (turn.axis() * turn.angle()).cast<double>(),
      std::log(static_cast<double>(alike.scale / found.pose.scale));
  return error.dot(found.covariance.cast<double>().ldlt().solve(error));
}

PoseError errorOf(const Placement& found, const Placement& truth, const ModelSurface& surface,
                  const Symmetry& symmetry) {
  PoseError error;
  error.rotation_deg = angleBetween(found.rotation, nearestAlike(found.rotation, truth, symmetry).rotation);
  error.add_s = addS(found, truth, surface);
  error.translation_mm = static_cast<double>((found.translation - truth.translation).norm());
  error.scale_percent = 100 * (static_cast<double>(found.scale) / static_cast<double>(truth.scale) - 1);
  return error;
}

}  // namespace voxid::cli
