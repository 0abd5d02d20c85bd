// SPDX-License-Identifier: BSD-3-Clause
// What a surface looks like round the line of sight, so that a turn about it is a shift.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "observation.h"

namespace voxid {

/// Depths on rings of equal area round the line of sight through a centroid, in shares of the points' radius.
struct PolarLook {
  static constexpr int kRings = 16, kRolls = 72;
  static constexpr int kOutside = 255,
                       kClip = 48;  ///< a difference counts up to kClip; outside differs from all inside
  std::array<std::array<std::uint8_t, kRolls>, kRings> value;
};
PolarLook polarLook(const Observation& seen);

/// The smallest rotation that takes the optical axis to a unit vector in front of the camera.
Eigen::Matrix3f rotationFromAxisTo(const Eigen::Vector3f& to);
/// A turn about the optical axis by a step of PolarLook.
Eigen::Matrix3f rollBy(int step);

/// One look of a model, with what makes a pose of it.
struct ModelLook {
  PolarLook look;
  Eigen::Matrix3f rotation;  ///< model to the line of sight's frame
  Eigen::Vector3f centre;    ///< of the model, from the visible points' centroid, in that frame; model's unit
  float radius = 0;          ///< of the visible points, model's unit
};

struct AlignableModel::Looks {
  std::vector<ModelLook> list;  ///< directions that show nothing are left out
};

/// A pose to begin with.
struct Start {
  Placement pose;
  int difference = 0;  ///< of the looks, at most kRings * kRolls * kClip
};

/// The best rolls of all looks, best first, no two of them within 14 degrees.
std::vector<Start> findStarts(const AlignableModel::Looks& looks, const Observation& seen, int most);

}  // namespace voxid
