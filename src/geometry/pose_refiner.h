// SPDX-License-Identifier: BSD-3-Clause
// A pose that is nearly right becomes right, and is judged.
#pragma once

#include <vector>

#include "observation.h"
#include "surface_painter.h"
#include "voxid/geometry/alignment.h"

namespace voxid {

using PoseMatrix = Eigen::Matrix<float, kPoseUnknowns, kPoseUnknowns>;
using PoseVector = Eigen::Matrix<float, kPoseUnknowns, 1>;

/// One observation's demand on a pose.
struct PoseEquation {
  PoseVector slope;  ///< of the residual by the unknowns (PoseCovariance)
  float residual_mm;
  float weight;  ///< 1 / mm^2
  std::size_t cell;
};

/// How well a pose explains what was seen.
struct Judgement {
  float misfit = 1;     ///< see Alignment
  float explained = 0;  ///< see Alignment
  float fit_mm = 0;     ///< see Alignment
};

class PoseRefiner {
 public:
  /// How residuals are trusted from step to step: those beyond the reach count little, and it shrinks.
  struct Schedule {
    int steps;
    float first_reach, last_reach;  ///< shares of the model's diagonal; never below the sensor's noise
  };
  /// Gauss-Newton with the model drawn anew at each step.
  void refine(const ModelSurface& surface, const Observation& seen, const SupportPlane& support,
              const Schedule& schedule, bool outline, Placement& pose);

  /// Lifts a model that reaches farther than SupportPlane::kMostBelow_mm below the table.
  static void lift(const ModelSurface& surface, const SupportPlane& support, Placement& pose);

  Judgement judge(const ModelSurface& surface, const Observation& seen, const SupportPlane& support,
                  const Placement& pose);

  /// Of the errors' distribution at a pose that fits. Neighbouring residuals are not independent, so what blocks of
  /// pixels say is compared (a sandwich over blocks).
  PoseCovariance covarianceAt(const ModelSurface& surface, const Observation& seen, const SupportPlane& support,
                              bool outline, const Placement& pose);

 private:
  /// Fills equations_ from what is drawn.
  void collect(const Observation& seen, const SupportPlane& support, float reach_mm, bool outline,
               const Placement& pose);
  /// What a pixel counts in Alignment::misfit; nothing if it is of neither.
  struct Cost {
    float wrong = 0, all = 0;
  };
  Cost costOf(const Observation& seen, std::size_t cell);
  float shareBelow(const SupportPlane& support) const;
  void addDepth(const Observation& seen, std::size_t cell, float reach_mm, const Placement& pose);
  void addUncovered(const Observation& seen, std::size_t cell, float reach_mm, const Placement& pose);
  void addBare(const Observation& seen, std::size_t cell, float reach_mm, const Placement& pose);
  void addSupport(const SupportPlane& support, const Observation& seen, const Placement& pose);
  void addPull(const Observation& seen, std::size_t model_cell, std::size_t towards, float weight, float reach_mm,
               const Placement& pose);

  SurfacePainter painter_;
  std::vector<PoseEquation> equations_;
  std::vector<float> distances_;  ///< of the pixels that the model explains from its surface, mm
};

}  // namespace voxid
