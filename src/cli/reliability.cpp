// SPDX-License-Identifier: BSD-3-Clause
#include "reliability.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>

namespace voxid::cli {
namespace {

constexpr std::size_t kBins = 10;

}  // namespace

std::vector<Bin> reliabilityOf(const std::vector<Judged>& answers) {
  std::vector<Judged> sorted = answers;
  std::stable_sort(sorted.begin(), sorted.end(), [](const Judged& a, const Judged& b) { return a.said < b.said; });
  std::vector<Bin> bins;
  for (std::size_t i = 0; i < kBins; ++i) {
    const std::size_t first = i * sorted.size() / kBins, end = (i + 1) * sorted.size() / kBins;
    if (first == end) continue;
    Bin bin{0, 0, end - first};
    for (std::size_t k = first; k < end; ++k) {
      bin.said += sorted[k].said / static_cast<double>(bin.answers);
      bin.seen += (sorted[k].right ? 1.0 : 0.0) / static_cast<double>(bin.answers);
    }
    bins.push_back(bin);
  }
  return bins;
}

double calibrationError(const std::vector<Bin>& bins) {
  double error = 0, answers = 0;
  for (const Bin& bin : bins) {
    error += std::abs(bin.said - bin.seen) * static_cast<double>(bin.answers);
    answers += static_cast<double>(bin.answers);
  }
  return answers > 0 ? error / answers : 0;
}

double areaUnderCurve(const std::vector<double>& high, const std::vector<double>& low) {
  if (high.empty() || low.empty()) return 0.5;
  std::vector<double> sorted = low;
  std::sort(sorted.begin(), sorted.end());
  double wins = 0;
  for (const double score : high) {
    const auto [first, last] = std::equal_range(sorted.begin(), sorted.end(), score);
    wins += static_cast<double>(first - sorted.begin()) + static_cast<double>(last - first) / 2;
  }
  return wins / (static_cast<double>(high.size()) * static_cast<double>(low.size()));
}

double areaUnderCurve(const std::vector<Judged>& answers) {
  std::vector<double> right, wrong;
  for (const Judged& answer : answers) (answer.right ? right : wrong).push_back(answer.said);
  return areaUnderCurve(right, wrong);
}

std::vector<RiskPoint> riskCoverage(std::vector<Judged> answers) {
  std::sort(answers.begin(), answers.end(), [](const Judged& a, const Judged& b) { return a.said > b.said; });
  std::vector<RiskPoint> curve;
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < answers.size(); ++i) {
    wrong += !answers[i].right;
    if (i + 1 < answers.size() && answers[i + 1].said == answers[i].said) continue;
    const auto given = static_cast<double>(i + 1);
    curve.push_back({given / static_cast<double>(answers.size()), static_cast<double>(wrong) / given});
  }
  return curve;
}

double coverageAt(const std::vector<RiskPoint>& curve, double risk) {
  double coverage = 0;
  for (const RiskPoint& point : curve) {
    if (point.risk <= risk) coverage = std::max(coverage, point.coverage);
  }
  return coverage;
}

namespace {

const cv::Scalar kInk(60, 60, 60), kFaint(220, 220, 220), kBlue(170, 90, 20), kOrange(30, 120, 230);

/// A square from 0 to 1 both ways, y upwards.
class Panel {
 public:
  Panel(cv::Mat picture, int left_px) : picture_(std::move(picture)), left_px_(left_px) {}

  cv::Point at(double x, double y) const {
    return {left_px_ + static_cast<int>(std::lround(x * kSide_px)),
            kTop_px + static_cast<int>(std::lround((1 - y) * kSide_px))};
  }
  void frame(const std::string& title, const std::string& across, const std::string& upwards) {
    for (int i = 0; i <= 5; ++i) {
      const double share = i / 5.0;
      cv::line(picture_, at(share, 0), at(share, 1), kFaint);
      cv::line(picture_, at(0, share), at(1, share), kFaint);
      text(std::to_string(20 * i), at(share, 0) + cv::Point(-8, 18));
      text(std::to_string(20 * i), at(0, share) + cv::Point(-30, 5));
    }
    cv::rectangle(picture_, at(0, 0), at(1, 1), kInk);
    text(title, at(0, 1) + cv::Point(0, -28));
    text(upwards, at(0, 1) + cv::Point(0, -9));
    text(across, at(0.5, 0) + cv::Point(-70, 38));
  }
  void text(const std::string& words, cv::Point place, const cv::Scalar& colour = kInk) {
    cv::putText(picture_, words, place, cv::FONT_HERSHEY_SIMPLEX, 0.42, colour, 1, cv::LINE_AA);
  }
  void line(cv::Point a, cv::Point b, const cv::Scalar& colour) { cv::line(picture_, a, b, colour, 2, cv::LINE_AA); }
  void dot(cv::Point place) { cv::circle(picture_, place, 5, kBlue, cv::FILLED, cv::LINE_AA); }
  void curve(const std::vector<RiskPoint>& points, const cv::Scalar& colour) {
    for (std::size_t i = 1; i < points.size(); ++i)
      line(at(points[i - 1].coverage, points[i - 1].risk), at(points[i].coverage, points[i].risk), colour);
  }

  static constexpr int kSide_px = 360, kTop_px = 60;

 private:
  cv::Mat picture_;
  int left_px_;
};

}  // namespace

cv::Mat drawReliability(const std::vector<Bin>& bins, const std::vector<RiskPoint>& closed,
                        const std::vector<RiskPoint>& open) {
  constexpr int kMargin_px = 60;
  cv::Mat picture(Panel::kTop_px + Panel::kSide_px + kMargin_px, 2 * (Panel::kSide_px + kMargin_px) + kMargin_px,
                  CV_8UC3, cv::Scalar::all(255));
  Panel left(picture, kMargin_px), right(picture, 2 * kMargin_px + Panel::kSide_px + 20);
  left.frame("Reliability, a tenth of the answers a dot", "said to be right, %", "right, %");
  left.line(left.at(0, 0), left.at(1, 1), kFaint);
  for (const Bin& bin : bins) left.dot(left.at(bin.said, bin.seen));
  right.frame("Risk over coverage", "answered, %", "wrong among the answered, %");
  right.curve(open, kOrange);
  right.curve(closed, kBlue);
  right.text("a quarter of the categories left out", right.at(0.05, 0.92), kOrange);
  right.text("every category there", right.at(0.05, 0.86), kBlue);
  return picture;
}

}  // namespace voxid::cli
