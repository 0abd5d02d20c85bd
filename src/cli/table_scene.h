// SPDX-License-Identifier: BSD-3-Clause
// A table with models on it, to be seen by the sensor model.
#pragma once

#include <cstdint>
#include <vector>

#include "voxid/library/renderer.h"
#include "voxid/library/sensor_model.h"

namespace voxid::cli {

/// A mesh that is to stand on the table.
struct Prop {
  Mesh mesh;
  bool y_up = true;    ///< else z
  double size_mm = 0;  ///< largest extent of its box as it stands
};

/// A table 1.2 x 0.8 m, its frame: x right, y away from the camera, z up, origin in the middle of its top; millimetres.
struct TableScene {
  RayScene scene;    ///< mesh 0 is the table, mesh i the i-th prop
  Placement camera;  ///< table to camera
};

/// Props stand without touching in rows, the tallest behind, each turned and moved a little by chance; the camera looks
/// down by 30 to 45 degrees from 0.9 to 1.05 m. BadUse if they do not fit.
Result<TableScene> setTable(const std::vector<Prop>& props, std::uint64_t seed);

/// The sensor as it sees scenes: more holes, nothing cut.
SensorParams sceneSensor();

}  // namespace voxid::cli
