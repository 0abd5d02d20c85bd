// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "voxid/core/depth_view.h"
#include "voxid/library/mesh.h"

namespace voxid {

/// Enough to leave no gap in a 64 x 64 x 64 grid that VoxelGrid::close() does not fill.
constexpr int kSurfacePoints = 16384;

/// `count` points spread evenly over all triangles, those inside the model too, by area. The box round the mesh gets a
/// diagonal of one metre and its centre at zero; y up becomes y down, as in images. A function of the mesh alone.
/// `mesh` is as keepRenderable() leaves it.
std::vector<PointUm> surfacePoints(const Mesh& mesh, int count = kSurfacePoints);

}  // namespace voxid
