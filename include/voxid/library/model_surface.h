// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "voxid/core/kept_surface.h"
#include "voxid/geometry/alignment.h"
#include "voxid/geometry/symmetry.h"
#include "voxid/library/mesh.h"

namespace voxid {

/// A mesh in its unitPlacement, as alignment takes it: the box's centre is the origin, its diagonal 1.
ModelSurface surfaceOf(const Mesh& mesh);

/// The bytes of a KeptSurface, with the symmetries that the surface has once it is read again. Vertices that share a
/// cell of a grid of kKeptCells along the diagonal become one; of a coarser grid where that leaves too many.
std::vector<std::uint8_t> surfaceToKeep(const Mesh& mesh);
constexpr int kKeptCells = 256;

/// What surfaceToKeep was given, in the same placement.
ModelSurface surfaceOf(const KeptSurface& kept);
Symmetry symmetryOf(const KeptSurface& kept);

}  // namespace voxid
