// SPDX-License-Identifier: BSD-3-Clause
// Points as files.
#pragma once

#include <string>
#include <vector>

#include "voxid/core/depth_view.h"
#include "voxid/core/status.h"

namespace voxid::cli {

/// Ends in .pcd or .xyz, in any case of letters.
bool isPointFile(const std::string& path);

/// Reads a PCD file (fields x, y, z; ASCII, binary or compressed) or a text file with "x y z" on each line, both in
/// metres. Points with a coordinate that is not finite, or farther than 2,147 m, are left out. CannotDo for a missing
/// file or one without x, y, z; Damaged for one that is empty or cut.
Result<std::vector<PointUm>> readPointFile(const std::string& path);

}  // namespace voxid::cli
