// SPDX-License-Identifier: BSD-3-Clause
// Depth images and their cameras as files.
#pragma once

#include <CLI/CLI.hpp>
#include <opencv2/core.hpp>
#include <string>

#include "voxid/core/depth_view.h"
#include "voxid/core/status.h"

namespace voxid::cli {

/// A depth image read from a file (PNG or TIFF; 16-bit millimetres or 32-bit float metres) with the camera that goes
/// with it.
struct DepthFile {
  std::string path;
  cv::Mat pixels;  ///< CV_16UC1 or CV_32FC1
  Camera camera;

  DepthView view() const;
};

/// How a command line names the camera: "fx,fy,cx,cy" in pixels, or the path of a camera_info YAML (as
/// camera_calibration writes it). Empty: camera_info.yaml in the image's folder, else 525,525,319.5,239.5 at 640 x 480
/// (scaled to the image's size), which is said once on stderr.
struct CameraChoice {
  std::string text;
  void addTo(CLI::App& app);  ///< --camera
};

/// CannotDo for a missing file, Damaged for one that is empty or cut, CannotDo for one that holds no depth (8-bit,
/// colour).
Result<DepthFile> readDepthFile(const std::string& path, const CameraChoice& camera);

}  // namespace voxid::cli
