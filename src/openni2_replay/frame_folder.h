// SPDX-License-Identifier: BSD-3-Clause
// A folder of depth images, decoded once and held.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace voxid::replay {

/// Where a frame's images are. `colour` is empty if there is none.
struct FramePaths {
  std::string depth, colour;
};

/// In the order of names (bytes): NAME_depth.png with NAME_color.{jpg,jpeg,png}; else depth/NAME.png with
/// rgb/NAME.{jpg,jpeg,png}; else every .png. Empty if there are none.
std::vector<FramePaths> findFrames(const std::string& folder);

/// About 0.6 MB a VGA depth frame and 0.9 MB a colour frame.
class FrameFolder {
 public:
  /// Decodes all depth images, and the colour images if every frame has one. False with one sentence in `problem`.
  bool load(const std::string& folder, std::string& problem);

  int size() const { return static_cast<int>(depth_.size()); }
  const cv::Mat& depth(int i) const { return depth_[static_cast<std::size_t>(i)]; }    ///< CV_16UC1, mm
  const cv::Mat& colour(int i) const { return colour_[static_cast<std::size_t>(i)]; }  ///< CV_8UC3, RGB
  bool hasColour() const { return !colour_.empty(); }
  int width_px() const { return depth_.front().cols; }
  int height_px() const { return depth_.front().rows; }
  double fx_px() const { return fx_px_; }  ///< from camera_info.yaml, else 525 at 640 columns, in proportion
  double fy_px() const { return fy_px_; }

 private:
  bool loadDepth(const std::string& path, std::string& problem);
  bool loadColour(const std::string& path, std::string& problem);
  bool loadCamera(const std::string& path, std::string& problem);

  std::vector<cv::Mat> depth_, colour_;
  double fx_px_ = 0, fy_px_ = 0;
};

}  // namespace voxid::replay
