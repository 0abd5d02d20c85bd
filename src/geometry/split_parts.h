// SPDX-License-Identifier: BSD-3-Clause
// The order of a split's steps, the same for the splitter and for its twin in the tests.
#pragma once

#include <cstddef>
#include <cstdint>

#include "components.h"
#include "surface.h"
#include "voxid/geometry/segment_params.h"

namespace voxid {

/// Makes several parts of each that creases divide into pieces of at least `fewest` pixels.
template <typename Steps>
void splitParts(Steps& steps, const Surface& surface, const Camera& camera, std::size_t fewest,
                const SegmentParams& params, Components& components) {
  steps.step_ = DepthStep(params.split_step_mm);
  const std::size_t parts = components.parts();
  for (std::size_t part = 0; part < parts; ++part) {
    if (components.pixelsIn(part) < 2 * fewest) continue;
    const Span<const Run> runs = components.runsOf(part);
    steps.takeCells(surface.inverse, runs);
    steps.linkCells();
    steps.orientCells(camera);
    steps.markCreases(params.split_angle_deg);
    const std::uint8_t count = steps.findPieces(fewest);
    if (count < 2) continue;
    steps.growPieces();
    if (steps.rejoin(count, params.split_share_percent) < 2) continue;
    const std::size_t pieces = steps.cutRuns(surface.inverse, runs);
    components.cut(part, {steps.cuts_.data(), steps.cuts_.size()}, pieces);
  }
}

}  // namespace voxid
