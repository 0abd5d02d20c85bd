// SPDX-License-Identifier: BSD-3-Clause
#include "draw_confusion.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <opencv2/imgproc.hpp>
#include <set>
#include <string>

namespace voxid::cli {
namespace {

constexpr int kCell_px = 11, kNames_px = 130, kSummary_px = 200, kGap_px = 4;
constexpr double kFontScale = 0.3;

struct Confusion {
  std::vector<std::string> asked, answered;  ///< `answered` begins with all of `asked`
  std::vector<std::vector<int>> counts;      ///< by place in `asked`, then in `answered`
};

std::string answerOf(const Outcome& outcome) { return outcome.label.empty() ? "-" : outcome.label; }

Confusion confusionOf(const std::vector<Query>& queries, const std::vector<Outcome>& outcomes) {
  std::set<std::string> asked, others;
  for (const Query& query : queries) asked.insert(query.category);
  for (const Outcome& outcome : outcomes) {
    if (asked.count(answerOf(outcome)) == 0) others.insert(answerOf(outcome));
  }
  Confusion confusion{{asked.begin(), asked.end()}, {asked.begin(), asked.end()}, {}};
  confusion.answered.insert(confusion.answered.end(), others.begin(), others.end());
  std::map<std::string, std::size_t> places;
  for (std::size_t i = 0; i < confusion.answered.size(); ++i) places[confusion.answered[i]] = i;
  confusion.counts.resize(asked.size(), std::vector<int>(confusion.answered.size()));
  for (std::size_t i = 0; i < queries.size(); ++i)
    ++confusion.counts[places[queries[i].category]][places[answerOf(outcomes[i])]];
  return confusion;
}

int pixels(std::size_t cells) { return kCell_px * static_cast<int>(cells); }

int widthOf(const std::string& text) {
  return cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, kFontScale, 1, nullptr).width;
}

/// On the line of cells number `row`.
void write(const std::string& text, int left_px, std::size_t row, cv::Mat picture) {
  cv::putText(picture, text, {left_px, pixels(row + 1) - 2}, cv::FONT_HERSHEY_SIMPLEX, kFontScale, {60, 60, 60}, 1,
              cv::LINE_AA);
}

std::string shortened(std::string name) {
  while (widthOf(name) > kNames_px - 2 * kGap_px) name.pop_back();
  return name;
}

void writeRowNames(const std::vector<std::string>& names, cv::Mat strip) {
  for (std::size_t row = 0; row < names.size(); ++row) {
    const std::string name = shortened(names[row]);
    write(name, kNames_px - kGap_px - widthOf(name), row, strip);
  }
}

/// Read upwards, from the cells on.
void writeColumnNames(const std::vector<std::string>& names, cv::Mat strip) {
  cv::Mat lying(strip.cols, strip.rows, CV_8UC3, cv::Scalar::all(255));
  for (std::size_t column = 0; column < names.size(); ++column) write(shortened(names[column]), kGap_px, column, lying);
  cv::rotate(lying, lying, cv::ROTATE_90_COUNTERCLOCKWISE);
  lying.copyTo(strip);
}

void shadeRow(const std::vector<int>& counts, std::size_t row, cv::Mat cells) {
  const int all = std::accumulate(counts.begin(), counts.end(), 0);
  for (std::size_t column = 0; column < counts.size(); ++column) {
    const double light = 235 - 235.0 * counts[column] / all;
    const cv::Scalar colour = row == column ? cv::Scalar(light, 160, light) : cv::Scalar(light, light, 255);
    const cv::Rect cell(pixels(column), pixels(row), kCell_px, kCell_px);
    if (counts[column] > 0) cv::rectangle(cells, cell, colour, cv::FILLED);
    cv::rectangle(cells, cell, cv::Scalar::all(225), 1);
  }
}

std::string summaryOf(const Confusion& confusion, std::size_t row) {
  std::vector<int> counts = confusion.counts[row];
  const int all = std::accumulate(counts.begin(), counts.end(), 0), right = counts[row];
  counts[row] = 0;
  const auto similar = std::max_element(counts.begin(), counts.end());
  const std::string text = std::to_string(right) + " of " + std::to_string(all);
  return *similar == 0 ? text : text + ", " + confusion.answered[static_cast<std::size_t>(similar - counts.begin())];
}

}  // namespace

cv::Mat drawConfusion(const std::vector<Query>& queries, const std::vector<Outcome>& outcomes) {
  const Confusion confusion = confusionOf(queries, outcomes);
  const int width = pixels(confusion.answered.size()), height = pixels(confusion.asked.size());
  cv::Mat picture(kNames_px + height + 1, kNames_px + width + kSummary_px, CV_8UC3, cv::Scalar::all(255));
  writeColumnNames(confusion.answered, picture({kNames_px, 0, width, kNames_px}));
  writeRowNames(confusion.asked, picture({0, kNames_px, kNames_px, height}));
  const cv::Mat cells = picture({kNames_px, kNames_px, width, height});
  const cv::Mat margin = picture({kNames_px + width, kNames_px, kSummary_px, height});
  for (std::size_t row = 0; row < confusion.asked.size(); ++row) {
    shadeRow(confusion.counts[row], row, cells);
    write(summaryOf(confusion, row), kGap_px, row, margin);
  }
  return picture;
}

}  // namespace voxid::cli
