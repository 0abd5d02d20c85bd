// SPDX-License-Identifier: BSD-3-Clause
// The paper's descriptor in floating point: what integers and bytes cost is measured against it.
#pragma once

#include <array>

#include "voxid/core/descriptor.h"

namespace voxid::cli {

/// The 416 bins of voxid/core/descriptor.h before they are rounded: 255 sqrt(share), the ratio histogram half of that.
using FloatShapes = std::array<float, kDescriptorBytes>;

/// D2 alone: the bins that need no lines.
constexpr int kDistanceBins = 32 + 128;

/// The same pairs of points as the Describer draws. `points` are 2 to 65,536 that differ.
FloatShapes floatShapesOf(Span<const PointUm> points, const DescriptorParams& params);

}  // namespace voxid::cli
