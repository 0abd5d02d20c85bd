// SPDX-License-Identifier: BSD-3-Clause
// A device's frames into an .oni file.
#pragma once

#include <atomic>
#include <functional>
#include <string>

#include "voxid/capture/device.h"

namespace voxid {

struct RecordLimits {
  int frames = 0;                           ///< depth frames; 0: no limit
  double seconds = 0;                       ///< 0: no limit
  int silence_ms = 5000;                    ///< without a frame for this long the device is given up
  const std::atomic<bool>* stop = nullptr;  ///< set by somebody else: finish the file now
};

struct RecordReport {
  int frames = 0;  ///< depth frames in the file
  double seconds = 0;
};

/// Records until a limit, `stop`, or the end of what the device plays. Depth is stored without loss, colour (if the
/// device was opened with it) too. Written beside `path` and renamed once whole; whatever goes wrong, an older file of
/// that name stays. A device that vanishes midway leaves what came until then, and CannotDo. No frame at all: CannotDo
/// and no file. `progress` is called with the number of depth frames after each.
Status record(Device& device, const std::string& path, const RecordLimits& limits, RecordReport& report,
              const std::function<void(int)>& progress = {});

}  // namespace voxid
