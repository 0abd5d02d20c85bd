// SPDX-License-Identifier: BSD-3-Clause
// The paper's descriptor in floating point: what integers and bytes cost is measured against it.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "voxid/core/descriptor.h"
#include "voxid/core/trace.h"

namespace voxid::cli {

/// The 416 bins of voxid/core/descriptor.h before they are rounded: 255 sqrt(share), the ratio histogram half of that.
using FloatShapes = std::array<float, kDescriptorBytes>;

/// D2 alone: the bins that need no lines.
constexpr int kDistanceBins = 32 + 128;

/// A point where the descriptor has it.
struct FloatSample {
  Eigen::Vector3d p;  ///< from the centroid; the grid reaches from -1/2 to 1/2
  Cell cell;
};

/// At least two points that differ. Above 65,536 every n-th is taken, evenly, as the Describer does.
std::vector<FloatSample> samplesOf(Span<const PointUm> points);

/// The grid that lines are traced in.
VoxelGrid surfaceOf(const std::vector<FloatSample>& samples);

/// The same pairs of points as the Describer draws. `points` as for samplesOf().
FloatShapes floatShapesOf(Span<const PointUm> points, const DescriptorParams& params);

}  // namespace voxid::cli
