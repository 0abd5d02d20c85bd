// SPDX-License-Identifier: BSD-3-Clause
#include <opencv2/imgcodecs.hpp>

#include "table.h"

namespace voxid::cli {

cv::Mat decodePicture(const std::vector<std::uint8_t>& bytes) try {
  return cv::imdecode(bytes, cv::IMREAD_UNCHANGED);
} catch (const cv::Exception&) {
  return {};
}

cv::Mat readPicture(const std::string& path) try {
  return cv::imread(path, cv::IMREAD_UNCHANGED);
} catch (const cv::Exception&) {
  return {};
}

bool writePicture(const std::string& path, const cv::Mat& picture) try {
  return cv::imwrite(path, picture);
} catch (const cv::Exception&) {
  return false;
}

}  // namespace voxid::cli
