// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "voxid/core/depth_view.h"
#include "voxid/geometry/scene.h"
#include "voxid/geometry/segment_params.h"

namespace voxid {

/// What the segmentation takes a depth image's pixels for, for people to look at: row * width + column, ascending.
struct TableAndAbove {
  std::vector<std::uint32_t> table;  ///< not above it, and at most min_height_mm below
  std::vector<std::uint32_t> above;  ///< at least min_height_mm and min_margin_per_km above it, below max_height_mm
};

/// Pixels outside the depth range are in neither list. `table` is a scene's.
void divide(const DepthView& depth, const Table& table, const SegmentParams& params, TableAndAbove& parts);

}  // namespace voxid
