// SPDX-License-Identifier: BSD-3-Clause
// The paper's Fig. 7.
#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "voxid/core/descriptor.h"

namespace voxid::cli {

/// A view that is held against the drawn one.
struct DrawnMatch {
  const std::uint8_t* bins = nullptr;  ///< 416
  std::string caption;
};

/// CV_8UC3, a panel for each of the six sub-histograms: the descriptor as green bars and, if `match` is not null, the
/// match as a red curve, to the same scale, with a line above that says what they are.
cv::Mat drawDescriptor(const Descriptor& bins, const DrawnMatch* match);

}  // namespace voxid::cli
