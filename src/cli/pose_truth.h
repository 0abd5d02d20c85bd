// SPDX-License-Identifier: BSD-3-Clause
// Fresh noisy views of models in known poses, and how far from them an answer is.
#pragma once

#include <string>
#include <vector>

#include "voxid/geometry/symmetry.h"
#include "voxid/library/mesh.h"
#include "voxid/library/sensor_model.h"

namespace voxid::cli {

/// A view that no index holds.
struct PosedView {
  DepthImage image;
  std::vector<std::uint32_t> pixels;
  Placement pose;  ///< of the model of unit diagonal, mm
};

/// From any direction, with any roll, size, distance and place as the views of an index (ViewRange), and their noise.
/// The same for the same seed. Views with fewer than 400 pixels are drawn again, at most eight times.
PosedView drawPosedView(const Mesh& mesh, std::uint64_t seed);

struct PoseError {
  double rotation_deg = 180;    ///< least over the model's symmetry
  double add_s = 1;             ///< mean distance to the nearest point of the true surface, in diagonals
  double translation_mm = 1e9;  ///< of the box's centre
  double scale_percent = 1e9;   ///< signed: positive is too large

  /// (rotation within 5 degrees or ADD-S below 2 %) and translation within 5 mm and scale within 3 %.
  bool strict() const;
};

/// The error squared, in deviations of the answer's covariance: on average kPoseUnknowns if that is honest. Modulo
/// symmetry.
double normalisedError(const Alignment& found, const Placement& truth, const Symmetry& symmetry);

PoseError errorOf(const Placement& found, const Placement& truth, const ModelSurface& surface,
                  const Symmetry& symmetry);

}  // namespace voxid::cli
