// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "voxid/geometry/alignment.h"

namespace voxid {

/// Vertices that share a cell of a grid of `cells` along the diagonal (2 to 512) become one, their mean; triangles that
/// this leaves without an area, or twice there, go. What is thinner than a cell keeps its outline.
ModelSurface thinned(const ModelSurface& surface, int cells);

}  // namespace voxid
