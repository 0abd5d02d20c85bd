// SPDX-License-Identifier: BSD-3-Clause
#include "draw_curves.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

namespace voxid::cli {
namespace {

const cv::Scalar kInk{60, 60, 60}, kFaint{225, 225, 225};
const std::vector<cv::Scalar> kColours{{40, 30, 210}, {200, 110, 30}, {80, 180, 70}, {180, 60, 160}, {30, 140, 220}};
constexpr int kWidth = 900, kHeight = 600, kLeft = 80, kRight = 190, kTop = 30, kBottom = 60;

struct Point {
  double recall, us;
  std::string setting;
};

struct Curve {
  std::string name;
  std::vector<Point> points;
};

/// A setting is what a point of a curve has beside its figures.
std::string settingOf(const Json& point) {
  for (const auto& [field, value] : point.items()) {
    if (value.is_number_integer() && field != "queries") return value.dump();
  }
  return {};
}

std::vector<Curve> curvesOf(const Json& rows) {
  std::vector<Curve> curves;
  for (const Json& row : rows) {
    if (!row.contains("recall10")) continue;
    Curve curve{row["name"].get<std::string>(), {}};
    for (const Json& point : row.contains("curve") ? row["curve"] : Json::array({row})) {
      curve.points.push_back({point["recall10"].get<double>(), point["median_us"].get<double>(),
                              row.contains("curve") ? settingOf(point) : std::string()});
    }
    curves.push_back(std::move(curve));
  }
  return curves;
}

class Plot {
 public:
  explicit Plot(const std::vector<Curve>& curves) : picture_(kHeight, kWidth, CV_8UC3, cv::Scalar::all(255)) {
    double least_us = 1e9, most_us = 1;
    for (const Curve& curve : curves) {
      for (const Point& point : curve.points) {
        least_recall_ = std::min(least_recall_, std::floor(point.recall * 10) / 10);
        least_us = std::min(least_us, point.us);
        most_us = std::max(most_us, point.us);
      }
    }
    least_decade_ = std::floor(std::log10(least_us));
    most_decade_ = std::max(std::ceil(std::log10(most_us)), least_decade_ + 1);
  }

  void drawAxes() {
    for (int tenth = static_cast<int>(std::lround(least_recall_ * 10)); tenth <= 10; ++tenth) {
      const int x = at({tenth / 10.0, 1, {}}).x;
      cv::line(picture_, {x, kTop}, {x, kHeight - kBottom}, kFaint);
      write(cv::format("%.1f", tenth / 10.0), {x - 12, kHeight - kBottom + 20}, kInk);
    }
    for (double decade = least_decade_; decade <= most_decade_; ++decade) {
      const int y = at({1, std::pow(10, decade), {}}).y;
      cv::line(picture_, {kLeft, y}, {kWidth - kRight, y}, kFaint);
      write(cv::format("%g", std::pow(10, decade)), {20, y + 4}, kInk);
    }
    write("recall@10", {kLeft + (kWidth - kLeft - kRight) / 2 - 35, kHeight - 15}, kInk);
    write("us a query (median)", {8, 18}, kInk);
  }

  void draw(const Curve& curve, const cv::Scalar& colour, int row) {
    std::vector<cv::Point> line;
    for (const Point& point : curve.points) line.push_back(at(point));
    cv::polylines(picture_, line, false, colour, 1, cv::LINE_AA);
    for (std::size_t i = 0; i < line.size(); ++i) {
      cv::circle(picture_, line[i], 3, colour, cv::FILLED, cv::LINE_AA);
      write(curve.points[i].setting, line[i] + cv::Point(6, row % 2 == 0 ? -5 : 13), colour);
    }
    write(curve.name, {kWidth - kRight + 15, kTop + 20 + 22 * row}, colour);
  }

  const cv::Mat& picture() const { return picture_; }

 private:
  cv::Point at(const Point& point) const {
    const double across = (point.recall - least_recall_) / std::max(1 - least_recall_, 0.1);
    const double up = (std::log10(point.us) - least_decade_) / (most_decade_ - least_decade_);
    return {kLeft + static_cast<int>(std::lround(across * (kWidth - kLeft - kRight))),
            kHeight - kBottom - static_cast<int>(std::lround(up * (kHeight - kTop - kBottom)))};
  }
  void write(const std::string& text, cv::Point where, const cv::Scalar& colour) {
    cv::putText(picture_, text, where, cv::FONT_HERSHEY_SIMPLEX, 0.42, colour, 1, cv::LINE_AA);
  }

  cv::Mat picture_;
  double least_recall_ = 0.9, least_decade_ = 0, most_decade_ = 1;
};

}  // namespace

cv::Mat drawCurves(const Json& rows) {
  const std::vector<Curve> curves = curvesOf(rows);
  Plot plot(curves);
  plot.drawAxes();
  for (std::size_t i = 0; i < curves.size(); ++i)
    plot.draw(curves[i], kColours[i % kColours.size()], static_cast<int>(i));
  return plot.picture();
}

}  // namespace voxid::cli
