// SPDX-License-Identifier: BSD-3-Clause
#include "picture_file.h"

#include "on_demand.h"
#include "pictures/table.h"

namespace voxid::cli {
namespace {

const PictureTable& pictures() {
  static const auto& table = *static_cast<const PictureTable*>(tableOf("pictures"));
  return table;
}

}  // namespace

cv::Mat decodePicture(const std::vector<std::uint8_t>& bytes) { return pictures().decode(bytes); }
cv::Mat readPicture(const std::string& path) { return pictures().read(path); }
bool writePicture(const std::string& path, const cv::Mat& picture) { return pictures().write(path, picture); }

}  // namespace voxid::cli
