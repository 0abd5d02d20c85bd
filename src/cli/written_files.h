// SPDX-License-Identifier: BSD-3-Clause
// Files that are written of frames, one of each or more.
#pragma once

#include <string>
#include <vector>

#include "voxid/core/status.h"

namespace voxid::cli {

/// FOLDER/STEM.png, STEM being the frame's name without its ending.
std::string labelsPath(const std::string& folder, const std::string& frame);

/// BadUse if label images or pictures of the frames would replace a frame, or one another. `labels`, `plot`: as given,
/// empty for none.
Status checkWritten(const std::vector<std::string>& frames, const std::string& labels, const std::string& plot);

}  // namespace voxid::cli
