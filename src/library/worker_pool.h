// SPDX-License-Identifier: BSD-3-Clause
// Work on numbered items in processes, so that an item that crashes costs itself only.
#pragma once

#include <functional>
#include <string>

#include "voxid/core/status.h"

namespace voxid {

struct PoolWork {
  int items = 0;
  /// In a worker: works on an item, gives a number >= 0 back. A refusal ends everything: nothing more can be done.
  std::function<Result<int>(int item)> work;
  /// In the calling process, in the order in which items end.
  std::function<void(int item, int result)> onDone;
  std::function<void(int item, const std::string& how)> onDied;
  std::function<void()> onTick;  ///< some ten times a second
};

/// Forks `jobs` workers, which take items in ascending order; a worker that dies is replaced. The first refusal, if
/// any. Workers end with it, also if one of the functions throws, and with the calling process, however that ends.
Status runInProcesses(int jobs, const PoolWork& work);

}  // namespace voxid
