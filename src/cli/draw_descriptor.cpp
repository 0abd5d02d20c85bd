// SPDX-License-Identifier: BSD-3-Clause
#include "draw_descriptor.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace voxid::cli {
namespace {

const cv::Scalar kInk{60, 60, 60}, kGreen{80, 180, 70}, kRed{40, 30, 210};
constexpr int kMargin = 24;

void write(const std::string& text, cv::Point at, const cv::Scalar& colour, cv::Mat picture) {
  cv::putText(picture, text, at, cv::FONT_HERSHEY_SIMPLEX, 0.42, colour, 1, cv::LINE_AA);
}

/// One sub-histogram: bins along x, `highest` fills the panel's height.
class Panel {
 public:
  Panel(cv::Mat panel, int bins, int highest) : panel_(std::move(panel)), bins_(bins), highest_(std::max(highest, 1)) {}

  void drawBars(const std::uint8_t* values, const cv::Scalar& colour) {
    for (int i = 0; i < bins_; ++i) {
      const int left = leftOf(i), right = std::max(left, leftOf(i + 1) - 1);
      if (values[i] > 0) cv::rectangle(panel_, {left, topOf(values[i])}, {right, base()}, colour, cv::FILLED);
    }
  }

  void drawCurve(const std::uint8_t* values, const cv::Scalar& colour) {
    std::vector<cv::Point> curve;
    for (int i = 0; i < bins_; ++i) curve.emplace_back((leftOf(i) + leftOf(i + 1)) / 2, topOf(values[i]));
    cv::polylines(panel_, curve, false, colour, 1, cv::LINE_AA);
  }

  void finish(const char* name) {
    cv::line(panel_, {kMargin, base()}, {panel_.cols - kMargin, base()}, kInk, 1);
    const std::string title =
        std::string(name) + ", " + std::to_string(bins_) + " bins, highest " + std::to_string(highest_);
    write(title, {kMargin, kMargin - 8}, kInk, panel_);
  }

 private:
  int base() const { return panel_.rows - kMargin; }
  int leftOf(int bin) const { return kMargin + (panel_.cols - 2 * kMargin) * bin / bins_; }
  int topOf(int value) const { return base() - (panel_.rows - 2 * kMargin) * value / highest_; }

  cv::Mat panel_;
  int bins_, highest_;
};

void drawHistogram(const SubHistogram& h, const Descriptor& bins, const DrawnMatch* match, cv::Mat picture) {
  const std::uint8_t* const query = bins.data() + h.first_bin;
  const std::uint8_t* const other = match ? match->bins + h.first_bin : query;
  Panel panel(std::move(picture), h.bins,
              std::max(*std::max_element(query, query + h.bins), *std::max_element(other, other + h.bins)));
  panel.drawBars(query, kGreen);
  if (match) panel.drawCurve(other, kRed);
  panel.finish(h.name);
}

}  // namespace

cv::Mat drawDescriptor(const Descriptor& bins, const DrawnMatch* match) {
  constexpr int kWidth = 360, kHeight = 220, kColumns = 3, kHeading = 28;
  const int heading = match ? kHeading : 0;
  cv::Mat picture(heading + 2 * kHeight, kColumns * kWidth, CV_8UC3, cv::Scalar(255, 255, 255));
  if (match) {
    write("green: the object", {kMargin, 20}, kGreen, picture);
    write("red: " + match->caption, {kMargin + 160, 20}, kRed, picture);
  }
  int i = 0;
  for (const SubHistogram& h : kSubHistograms) {
    const cv::Rect place(i % kColumns * kWidth, heading + i / kColumns * kHeight, kWidth, kHeight);
    drawHistogram(h, bins, match, picture(place));
    ++i;
  }
  return picture;
}

}  // namespace voxid::cli
