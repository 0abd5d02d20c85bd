// SPDX-License-Identifier: BSD-3-Clause
#include "picture_file.h"

#include "on_demand.h"
#include "pictures/table.h"

namespace voxid::cli {
namespace {

const PictureTable& table() { return tableOf<PictureTable>("pictures"); }

}  // namespace

cv::Mat decodePicture(const std::vector<std::uint8_t>& bytes) { return table().decode(bytes); }
cv::Mat readPicture(const std::string& path) { return table().read(path); }
bool writePicture(const std::string& path, const cv::Mat& picture) { return table().write(path, picture); }

}  // namespace voxid::cli
