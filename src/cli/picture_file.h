// SPDX-License-Identifier: BSD-3-Clause
// Pictures as files.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace voxid::cli {

/// A picture of any format that OpenCV knows, its pixels as they are stored; empty if it cannot be decoded.
cv::Mat decodePicture(const std::vector<std::uint8_t>& bytes);
/// The same from a file; empty also if it cannot be read.
cv::Mat readPicture(const std::string& path);
/// The path's ending says the format; false if it is none that OpenCV knows, or if the file cannot be written.
bool writePicture(const std::string& path, const cv::Mat& picture);

}  // namespace voxid::cli
