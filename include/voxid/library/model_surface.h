// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "voxid/core/kept_surface.h"
#include "voxid/geometry/alignment.h"
#include "voxid/geometry/symmetry.h"
#include "voxid/library/mesh.h"

namespace voxid {

/// A mesh in its unitPlacement, as alignment takes it.
ModelSurface surfaceOf(const Mesh& mesh);

/// The surface as an index keeps it, and what it looks like read again: details below kKeptCells of the diagonal are
/// joined, coarser ones where that leaves too many vertices; symmetries are those of what is kept.
std::vector<std::uint8_t> surfaceToKeep(const Mesh& mesh);
constexpr int kKeptCells = 256;

ModelSurface surfaceOf(const KeptSurface& kept);
Symmetry symmetryOf(const KeptSurface& kept);

}  // namespace voxid
