// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>

#include "voxid/geometry/scene.h"
#include "voxid/geometry/segment_params.h"

namespace voxid {

/// Depth image -> table plane -> what stands on it. Memory is taken at construction and when an image is larger than
/// any before; otherwise a call allocates nothing. Same view and parameters, same scene. One object a thread.
class Segmenter {
 public:
  Segmenter();
  ~Segmenter();
  Segmenter(Segmenter&&) noexcept;
  Segmenter& operator=(Segmenter&&) noexcept;

  /// Never fails: the scene's status says what was (not) found. `up`: unit vector away from the ground, in the camera's
  /// frame, where it is known. A table's normal is within 30 degrees of it (and max_tilt_deg); otherwise within
  /// max_tilt_deg of the image's upward direction.
  const Scene& segment(const DepthView& depth, const SegmentParams& params,
                       const std::optional<Eigen::Vector3f>& up = {});

 private:
  struct Workspace;
  std::unique_ptr<Workspace> workspace_;
};

}  // namespace voxid
