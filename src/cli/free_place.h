// SPDX-License-Identifier: BSD-3-Clause
// Captions that do not lie on each other.
#pragma once

#include <opencv2/core/types.hpp>
#include <vector>

namespace voxid::cli {

/// `wanted` moved up or down, as little as it takes (by its own height's quarters, up first), to where it covers none
/// of `taken` and lies inside a picture `height_px` high; `wanted` itself if there is no such place.
inline cv::Rect freePlace(const cv::Rect& wanted, const std::vector<cv::Rect>& taken, int height_px) {
  const auto isFree = [&](const cv::Rect& place) {
    if (place.y < 0 || place.y + place.height > height_px) return false;
    for (const cv::Rect& other : taken) {
      if ((place & other).area() > 0) return false;
    }
    return true;
  };
  const int step = wanted.height > 4 ? wanted.height / 4 : 1;
  for (int shift = 0; shift < height_px; shift += step) {
    for (const int moved : {-shift, shift}) {
      const cv::Rect place = wanted + cv::Point(0, moved);
      if (isFree(place)) return place;
    }
  }
  return wanted;
}

}  // namespace voxid::cli
