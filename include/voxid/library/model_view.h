// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "voxid/library/sensor_model.h"

namespace voxid {

/// What the sensor shows of a model from one direction.
struct ModelView {
  DepthImage image;
  std::vector<std::uint32_t> pixels;  ///< those with depth, row * width + column, ascending
  float diagonal_mm = 0;              ///< how large the model was drawn
};

/// Of the visible points along the camera's axes, in 1/65,535 of the model's diagonal (format::View).
std::array<std::uint16_t, 3> extentsOf(const ModelView& view);

/// The view that an index is made of: size, distance, roll, place in the image and noise follow from `name`
/// (<category>/<model>) and `direction` (0 to 79, into viewDirections()). `scene` holds the model alone, in its
/// unitPlacement.
ModelView drawModelView(const RayScene& scene, const std::string& name, int direction);

}  // namespace voxid
