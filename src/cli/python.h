// SPDX-License-Identifier: BSD-3-Clause
// The sub-commands that are written in Python (python/voxid).
#pragma once

#include <string>
#include <vector>

#include "voxid/core/status.h"

namespace voxid::cli {

/// Becomes Python's `command` with these arguments; returns only if that fails.
Status handOver(const char* command, const std::vector<std::string>& arguments);

}  // namespace voxid::cli
