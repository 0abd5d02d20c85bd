// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>
#include <vector>

#include "voxid/core/status.h"

namespace voxid::cli {

/// The points of a PCD file (fields x, y, z; ASCII, binary or compressed), in metres as they stand there. CannotDo if
/// it lacks one of the fields; Damaged if it is cut or its header cannot be read.
Result<std::vector<std::array<float, 3>>> readPcdFile(const std::string& path);

}  // namespace voxid::cli
