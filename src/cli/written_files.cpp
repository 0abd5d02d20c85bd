// SPDX-License-Identifier: BSD-3-Clause
#include "written_files.h"

#include <filesystem>
#include <map>

#include "scene_json.h"

namespace voxid::cli {
namespace {

namespace fs = std::filesystem;

/// The same for every way of writing a path.
fs::path placeOf(const std::string& path) {
  std::error_code error;
  const fs::path place = fs::weakly_canonical(path, error);
  return error ? fs::path(path) : place;
}

}  // namespace

std::string labelsPath(const std::string& folder, const std::string& frame) {
  return (fs::path(folder) / (fs::path(frame).stem().string() + ".png")).string();
}

Status checkWritten(const std::vector<std::string>& frames, const std::string& labels, const std::string& plot) {
  std::map<fs::path, fs::path> frame_of;  // by what is written, or read
  for (const std::string& frame : frames) frame_of.emplace(placeOf(frame), placeOf(frame));
  for (const std::string& frame : frames) {
    for (const std::string& path : {labels.empty() ? "" : labelsPath(labels, frame),
                                    plot.empty() ? "" : plotPath(plot, frame, frames.size() == 1)}) {
      if (path.empty()) continue;
      const auto [there, is_new] = frame_of.emplace(placeOf(path), placeOf(frame));
      if (there->first == there->second)
        return Status::badUse(path + " would be written over, a frame itself; choose another place");
      if (!is_new && there->second != placeOf(frame))
        return Status::badUse(path + " would be written of two frames of one name; choose a place for each");
    }
  }
  return {};
}

}  // namespace voxid::cli
