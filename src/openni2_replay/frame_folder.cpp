// SPDX-License-Identifier: BSD-3-Clause
#include "frame_folder.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace fs = std::filesystem;

namespace voxid::replay {
namespace {

constexpr char kDepthEnd[] = "_depth.png";

bool endsWith(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

std::vector<std::string> filesEnding(const fs::path& folder, const std::string& end) {
  std::vector<std::string> names;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored))
    if (endsWith(entry.path().filename().string(), end)) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

std::string colourFile(const std::string& stem) {
  for (const char* end : {".jpg", ".jpeg", ".png"})
    if (fs::exists(stem + end)) return stem + end;
  return "";
}

std::vector<FramePaths> framesSideBySide(const fs::path& folder) {
  std::vector<FramePaths> frames;
  for (const std::string& name : filesEnding(folder, kDepthEnd)) {
    const std::string stem = name.substr(0, name.size() - (sizeof kDepthEnd - 1));
    frames.push_back({(folder / name).string(), colourFile((folder / (stem + "_color")).string())});
  }
  return frames;
}

std::vector<FramePaths> framesApart(const fs::path& depth, const fs::path& colour) {
  std::vector<FramePaths> frames;
  for (const std::string& name : filesEnding(depth, ".png")) {
    const std::string stem = fs::path(name).stem().string();
    frames.push_back({(depth / name).string(), colour.empty() ? "" : colourFile((colour / stem).string())});
  }
  return frames;
}

}  // namespace

std::vector<FramePaths> findFrames(const std::string& folder) {
  std::vector<FramePaths> frames = framesSideBySide(folder);
  if (frames.empty()) frames = framesApart(fs::path(folder) / "depth", fs::path(folder) / "rgb");
  if (frames.empty()) frames = framesApart(folder, {});
  return frames;
}

bool FrameFolder::load(const std::string& folder, std::string& problem) {
  const std::vector<FramePaths> frames = findFrames(folder);
  if (frames.empty()) {
    problem = folder + " holds no depth images (looked for *_depth.png, depth/*.png and *.png, 16-bit millimetres)";
    return false;
  }
  const bool colour = std::all_of(frames.begin(), frames.end(), [](const FramePaths& f) { return !f.colour.empty(); });
  for (const FramePaths& frame : frames) {
    if (!loadDepth(frame.depth, problem)) return false;
    if (colour && !loadColour(frame.colour, problem)) return false;
  }
  return loadCamera(folder + "/camera_info.yaml", problem);
}

bool FrameFolder::loadDepth(const std::string& path, std::string& problem) {
  cv::Mat image = cv::imread(path, cv::IMREAD_UNCHANGED);
  if (image.empty()) return problem = path + " cannot be read as a PNG", false;
  if (image.type() != CV_16UC1)
    return problem = path + " is not a depth image: expected one channel of 16 bits, millimetres", false;
  if (!depth_.empty() && image.size() != depth_.front().size())
    return problem = path + " differs in size from the images before it; a device has one size", false;
  depth_.push_back(std::move(image));
  return true;
}

bool FrameFolder::loadColour(const std::string& path, std::string& problem) {
  cv::Mat image = cv::imread(path, cv::IMREAD_COLOR);
  if (image.empty()) return problem = path + " cannot be read as an image", false;
  if (!colour_.empty() && image.size() != colour_.front().size())
    return problem = path + " differs in size from the images before it; a device has one size", false;
  cv::cvtColor(image, image, cv::COLOR_BGR2RGB);
  colour_.push_back(std::move(image));
  return true;
}

bool FrameFolder::loadCamera(const std::string& path, std::string& problem) {
  fx_px_ = fy_px_ = 525.0 * width_px() / 640.0;
  if (!fs::exists(path)) return true;
  try {
    const YAML::Node matrix = YAML::LoadFile(path)["camera_matrix"]["data"];
    fx_px_ = matrix[0].as<double>();
    fy_px_ = matrix[4].as<double>();
  } catch (const YAML::Exception& e) {
    return problem = path + " is not a camera_info YAML (" + e.what() + "); expected camera_matrix with nine numbers",
           false;
  }
  if (!(fx_px_ > 0 && fy_px_ > 0)) return problem = path + ": focal lengths must be positive", false;
  return true;
}

}  // namespace voxid::replay
