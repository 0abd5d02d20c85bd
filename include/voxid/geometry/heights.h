// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "voxid/core/depth_view.h"
#include "voxid/geometry/scene.h"

namespace voxid {

/// Pixels (row * width + column, ascending) whose points lie between two heights over the table's plane, millimetres,
/// the lower one included; for people to look at, the segmentation has finer rules. Pixels without depth are left out.
void pixelsBetween(const DepthView& depth, const Table& table, double least_mm, double most_mm,
                   std::vector<std::uint32_t>& pixels);

}  // namespace voxid
