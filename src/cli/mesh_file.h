// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "voxid/library/mesh_reader.h"

namespace voxid::cli {

/// readMesh(), whose refusals all begin with the path.
Result<Mesh> readMeshFile(const std::string& path);

}  // namespace voxid::cli
