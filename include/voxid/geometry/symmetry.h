// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "voxid/geometry/alignment.h"

namespace voxid {

/// Points spread evenly over a surface, and the distance from any point to them. Constant once made.
class SurfaceSamples {
 public:
  /// `count` points by area, the same every time; `phase` (0 to 1) shifts them along the surface. A surface without an
  /// area gives none.
  SurfaceSamples(const ModelSurface& surface, int count, float phase = 0);

  const std::vector<Eigen::Vector3f>& points() const { return points_; }
  /// Of the nearest sample; 2 if that is further than 2 diagonals or there is none.
  float distanceTo(const Eigen::Vector3f& point) const;

 private:
  static constexpr int kSide = 32;
  int cellOf(float x) const;
  float nearestInRing(const Eigen::Vector3f& point, const std::array<int, 3>& centre, int ring, float best) const;
  float nearestInCell(const Eigen::Vector3f& point, int x, int y, int z, float best) const;

  std::vector<Eigen::Vector3f> points_;     ///< by cell
  std::vector<std::uint32_t> cell_starts_;  ///< kSide^3 + 1
};

/// Turns about the axes of a model's own frame, through its box centre, that leave its surface where it was: about axis
/// i by multiples of 360 / folds[i] degrees. 1: none but the full turn; 0: any angle.
struct Symmetry {
  std::array<std::uint8_t, 3> folds{1, 1, 1};

  bool anyAngle(int axis) const { return folds[static_cast<std::size_t>(axis)] == 0; }
};

/// Turns the surface about its axes and compares it with itself: alike if their mean distance is below 0.6 % of the
/// diagonal. Takes some ten milliseconds.
Symmetry findSymmetry(const ModelSurface& surface);

/// The turns, with the half-turns about the other axes, the identity first; any angle in steps of 5 degrees.
std::vector<Eigen::Matrix3f> turnsOf(const Symmetry& symmetry);

}  // namespace voxid
