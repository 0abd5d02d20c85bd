// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace voxid::bench {

constexpr char kNamespace[] = "/voxid";

/// Is the nodelet manager: holds what voxid.launch loads, until SIGINT. Returns an exit code.
int runManager(int argc, char** argv);

}  // namespace voxid::bench
