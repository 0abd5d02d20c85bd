// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "random.h"
#include "voxid/library/mesh.h"

namespace voxid {

/// The mesh stretched along its axes, by up to 1.5 or its inverse each, and tapered along one: another thing of the
/// same category, as far as a projection is concerned that learns from it (doc/descriptor.md, section 7).
Mesh deformed(Mesh mesh, Random& random);

}  // namespace voxid
