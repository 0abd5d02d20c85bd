// SPDX-License-Identifier: BSD-3-Clause
// How a folder is played: from the environment or from a device URI.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace voxid::replay {

/// What the depth stream says its numbers mean.
enum class DepthCoding {
  Millimetre,  ///< as the PNGs hold them
  TenthMm,     ///< PIXEL_FORMAT_DEPTH_100_UM: ten times the PNG's, 0 where that does not fit
  Shift,       ///< PIXEL_FORMAT_SHIFT_9_2: a mode that readers of depth must refuse
};

struct Config {
  std::string folder;   ///< absolute
  std::string uri;      ///< what OpenNI2 calls the device; shorter than 256 characters
  std::string serial;   ///< default: "replay-" and the folder's last name
  std::string control;  ///< path of the control file or FIFO; empty: no faults
  int fps = 30;         ///< 1 to 1000
  int hold = 1;         ///< every image is shown this many times in a row
  bool loop = true;
  bool mirror = false;  ///< frames come mirrored, and that cannot be switched off
  DepthCoding coding = DepthCoding::Millimetre;
};

/// One device a folder of VOXID_REPLAY (separated by ':'), with VOXID_REPLAY_FPS, _LOOP, _HOLD, _SERIAL, _CONTROL,
/// _MIRROR, _UNIT. A bad value is reported in `problems`, one sentence each, and its default stays.
std::vector<Config> configsFromEnvironment(std::vector<std::string>& problems);

/// `replay:/folder?fps=30&loop=1&...`, names as above in small letters. Nothing for another scheme; for a bad value a
/// sentence in `problem`.
std::optional<Config> configFromUri(const std::string& uri, std::string& problem);

}  // namespace voxid::replay
