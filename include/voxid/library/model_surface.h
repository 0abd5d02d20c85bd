// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "voxid/geometry/alignment.h"
#include "voxid/library/mesh.h"

namespace voxid {

/// A mesh in its unitPlacement, as alignment takes it.
ModelSurface surfaceOf(const Mesh& mesh);

}  // namespace voxid
