// SPDX-License-Identifier: BSD-3-Clause
// An index as large as wanted, and how its searches do, warm and cold.
#pragma once

#include <string>
#include <vector>

#include "bench.h"

namespace voxid::cli {

struct ScaleOptions {
  std::string index;        ///< whose views are copied; of profile "default"
  std::uint32_t views = 0;  ///< wanted; copies are whole, so that it may be some more; not above its own: it is taken
                            ///< as it is
  std::string keep;         ///< where the large index stays; empty = in a temporary folder, and removed
};

/// Copies every model as often as it takes, each code moved by noise (fixed seed), writes the index as a build does,
/// and measures it: opening, searches, memory; times of searches are CPU times, of what waits for the disk wall clock.
/// CannotDo for "paper", or without room on the disk.
Result<Json> benchScale(const ScaleOptions& options, const std::vector<BenchView>& views);
void printScale(const Json& scale);

}  // namespace voxid::cli
