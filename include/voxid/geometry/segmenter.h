// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

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

  /// Never fails: the scene's status says what was (not) found.
  const Scene& segment(const DepthView& depth, const SegmentParams& params);

 private:
  struct Workspace;
  std::unique_ptr<Workspace> workspace_;
};

}  // namespace voxid
