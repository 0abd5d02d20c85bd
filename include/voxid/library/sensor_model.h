// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "voxid/library/renderer.h"
#include "voxid/library/views.h"

namespace voxid {

/// A depth image that owns its pixels: 16-bit millimetres along the optical axis, 0 = none, row-major.
struct DepthImage {
  Imager imager;
  std::vector<std::uint16_t> depth_mm;
  std::vector<std::uint16_t> objects;  ///< 1 + number of the mesh that each set pixel shows, 0 where there is no depth

  DepthView view() const;
  std::vector<std::uint32_t> setPixels() const;  ///< row * width + column, ascending
};

/// A structured-light sensor of the Kinect's kind. The defaults are those of the views that an index is made of;
/// training with this noise instead of clean views is worth five points of accuracy (doc/build.md).
struct SensorParams {
  float baseline_mm = 75;       ///< the projector stands so far to the right; what it does not light has no depth
  float least_cosine = 0.16f;   ///< surfaces seen under more than about 81 degrees from their normal give no depth
  float jitter_px = 0.5f;       ///< each pixel looks at a random point so far off its centre, at most
  float white_px = 0.05f;       ///< disparity noise of each pixel, standard deviation
  float correlated_px = 0.05f;  ///< disparity noise common to neighbours, standard deviation
  int correlation_px = 8;       ///< over so many pixels
  int steps_per_px = 8;         ///< disparity is quantised to 1/8 px
  float outline_loss = 0.5f;    ///< share of the pixels at an object's outline that give no depth
  int most_holes = 3;           ///< round holes a view, 0 to this
  float hole_radius_px = 4;     ///< largest
  float cut_share = 1 / 3.0f;   ///< share of the views whose lowest rows are missing, as where a table was cut away
  float cut_least = 0.02f, cut_most = 0.08f;  ///< of the object's rows
};

/// What the sensor delivers of a scene; the same for the same seed. `pose` takes scene to camera, millimetres.
DepthImage observe(const RayScene& scene, const Imager& imager, const Placement& pose, const SensorParams& params,
                   std::uint64_t seed);

/// What an ideal sensor would deliver.
DepthImage observeClean(const RayScene& scene, const Imager& imager, const Placement& pose);

/// How large and how far a model is drawn, before its depth is taken: as in the queries that it will be compared with.
struct ViewRange {
  float least_diagonal_mm = 120, most_diagonal_mm = 380;
  float least_distance_mm = 650, most_distance_mm = 1150;
  float most_shift_px =
      90;  ///< of the centre from the image's, across and down; less if the object would leave the image
};

/// A random pose of a model of unit diagonal (unitPlacement) seen from a direction: size, distance, roll and place in
/// the image are drawn, the direction is kept exactly.
Placement drawPose(const format::Direction& direction, const Imager& imager, const ViewRange& range,
                   std::uint64_t seed);

}  // namespace voxid
