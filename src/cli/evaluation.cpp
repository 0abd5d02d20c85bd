// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <opencv2/imgproc.hpp>
#include <random>
#include <set>

#include "voxid/core/coarse.h"

namespace voxid::cli {
namespace {

struct Tally {
  int right = 0, all = 0;
};

double percent(double right, double all) { return 100 * right / all; }

bool isRight(const Query& query, const Outcome& outcome) { return outcome.label == query.category; }

template <typename KeyOf>
std::vector<Tally> tallyBy(const std::vector<Query>& queries, const std::vector<Outcome>& outcomes, KeyOf key_of) {
  std::map<std::string, Tally> tallies;
  for (std::size_t i = 0; i < queries.size(); ++i) {
    Tally& tally = tallies[key_of(queries[i])];
    tally.right += isRight(queries[i], outcomes[i]);
    ++tally.all;
  }
  std::vector<Tally> list;
  for (const auto& entry : tallies) list.push_back(entry.second);
  return list;
}

double meanOfShares(const std::vector<Tally>& tallies) {
  double sum = 0;
  for (const Tally& tally : tallies) sum += percent(tally.right, tally.all);
  return sum / static_cast<double>(tallies.size());
}

std::string modelOf(const Query& query) { return query.category + "/" + query.model; }

struct Interval {
  double low, high;
};

/// 95 % of the resampled right / all. Views of one model are not independent, so whole models are drawn.
Interval resampled(const std::vector<Tally>& models) {
  constexpr int kResamplings = 2000;
  std::mt19937_64 generator(1);
  std::vector<double> shares;
  for (int i = 0; i < kResamplings; ++i) {
    Tally sum;
    for (std::size_t drawn = 0; drawn < models.size(); ++drawn) {
      const Tally& model = models[generator() % models.size()];
      sum.right += model.right;
      sum.all += model.all;
    }
    shares.push_back(percent(sum.right, sum.all));
  }
  std::sort(shares.begin(), shares.end());
  return {shares[shares.size() / 40], shares[shares.size() - 1 - shares.size() / 40]};
}

using Counts = std::map<std::pair<std::string, std::string>, int>;

/// Shades one row's cells by their share of the row.
void drawRow(const Counts& counts, const std::vector<std::string>& names, std::size_t row, int cell_px, int margin_px,
             cv::Mat& picture) {
  int all = 0;
  for (const std::string& answer : names) {
    const auto found = counts.find({names[row], answer});
    all += found == counts.end() ? 0 : found->second;
  }
  for (std::size_t column = 0; column < names.size(); ++column) {
    const auto found = counts.find({names[row], names[column]});
    if (found == counts.end()) continue;
    const double light = 235 - 235.0 * found->second / all;
    const cv::Scalar colour = row == column ? cv::Scalar(light, 160, light) : cv::Scalar(light, light, 255);
    const cv::Point corner(margin_px + static_cast<int>(column) * cell_px, margin_px + static_cast<int>(row) * cell_px);
    cv::rectangle(picture, cv::Rect(corner, cv::Size(cell_px, cell_px)), colour, cv::FILLED);
  }
}

/// At the row's end how much of it is right, and what it is mostly taken for otherwise. Nothing where nothing was
/// asked.
void writeSummary(const Counts& counts, const std::vector<std::string>& names, std::size_t row, cv::Point at,
                  cv::Mat& picture) {
  int all = 0, right = 0, most = 0;
  std::string similar;
  for (const std::string& answer : names) {
    const auto found = counts.find({names[row], answer});
    if (found == counts.end()) continue;
    all += found->second;
    if (answer == names[row]) right = found->second;
    if (answer == names[row] || found->second <= most) continue;
    most = found->second;
    similar = answer;
  }
  if (all == 0) return;
  const std::string text = std::to_string(right) + " of " + std::to_string(all) + (most > 0 ? ", " + similar : "");
  cv::putText(picture, text, at, cv::FONT_HERSHEY_SIMPLEX, 0.3, {60, 60, 60}, 1, cv::LINE_AA);
}

void writeNames(const std::vector<std::string>& names, int cell_px, int margin_px, cv::Mat& picture) {
  const cv::Scalar ink{60, 60, 60};
  cv::Mat turned = cv::Mat(picture.size(), picture.type(), cv::Scalar(255, 255, 255));
  for (std::size_t i = 0; i < names.size(); ++i) {
    const int y = margin_px + static_cast<int>(i) * cell_px + cell_px - 2;
    cv::putText(picture, names[i], {2, y}, cv::FONT_HERSHEY_SIMPLEX, 0.3, ink, 1, cv::LINE_AA);
    cv::putText(turned, names[i], {2, y}, cv::FONT_HERSHEY_SIMPLEX, 0.3, ink, 1, cv::LINE_AA);
  }
  cv::transpose(turned, turned);
  cv::flip(turned, turned, 1);
  // Turned clockwise: the names run from right to left; column i of the picture is read from the mirrored place.
  for (std::size_t i = 0; i < names.size(); ++i) {
    const int x = margin_px + static_cast<int>(i) * cell_px;
    turned(cv::Rect(turned.cols - x - cell_px, 0, cell_px, margin_px))
        .copyTo(picture(cv::Rect(x, 0, cell_px, margin_px)));
  }
}

}  // namespace

Figures figuresOf(const std::vector<Query>& queries, const std::vector<Outcome>& outcomes) {
  const auto total = static_cast<double>(queries.size());
  int right = 0, in_five = 0;
  double seconds = 0;
  for (std::size_t i = 0; i < queries.size(); ++i) {
    right += isRight(queries[i], outcomes[i]);
    in_five += outcomes[i].in_five;
    seconds += outcomes[i].seconds;
  }
  const auto by_category = tallyBy(queries, outcomes, [](const Query& q) { return q.category; });
  const Interval interval = resampled(tallyBy(queries, outcomes, modelOf));
  Figures figures;
  figures.top1 = percent(right, total);
  figures.mean_category = meanOfShares(by_category);
  figures.top5 = percent(in_five, total);
  figures.top1_low = interval.low;
  figures.top1_high = interval.high;
  figures.us_per_query = seconds * 1e6 / total;
  return figures;
}

Outcome outcomeOf(const Index& index, const Answer& answer, const std::string& category) {
  Outcome outcome;
  for (int i = 0; i < std::min(answer.count, 5); ++i) {
    const std::string_view label = index.categoryName(answer.alternatives[static_cast<std::size_t>(i)].category);
    if (i == 0) outcome.label = std::string(label);
    outcome.in_five |= label == category;
  }
  outcome.coarse = coarseAnswer(index, answer).synset;
  return outcome;
}

double rounded(double x) { return std::round(x * 100) / 100; }

Json rowOf(const std::string& descriptor, const char* method, const Figures& figures, double bytes_per_view) {
  Json row;
  row["descriptor"] = descriptor;
  row["method"] = method;
  row["top1"] = rounded(figures.top1);
  row["mean_category"] = rounded(figures.mean_category);
  row["top5"] = rounded(figures.top5);
  row["us_per_query"] = rounded(figures.us_per_query);
  row["bytes_per_view"] = rounded(bytes_per_view);
  row["top1_95"] = Json::array({rounded(figures.top1_low), rounded(figures.top1_high)});
  return row;
}

Difference differenceOf(const std::vector<Query>& queries, const std::vector<Outcome>& ours,
                        const std::vector<Outcome>& theirs) {
  std::vector<Tally> models = tallyBy(queries, ours, modelOf);
  const std::vector<Tally> other = tallyBy(queries, theirs, modelOf);
  Tally all;
  for (std::size_t i = 0; i < models.size(); ++i) {
    models[i].right -= other[i].right;
    all.right += models[i].right;
    all.all += models[i].all;
  }
  const Interval interval = resampled(models);
  return {percent(all.right, all.all), interval.low, interval.high};
}

cv::Mat drawConfusion(const std::vector<Query>& queries, const std::vector<Outcome>& outcomes) {
  Counts counts;
  std::set<std::string> met;
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const std::string answer = outcomes[i].label.empty() ? "-" : outcomes[i].label;
    ++counts[{queries[i].category, answer}];
    met.insert(queries[i].category);
    met.insert(answer);
  }
  constexpr int kCell_px = 11, kMargin_px = 120, kSummary_px = 200;
  const std::vector<std::string> names(met.begin(), met.end());
  const int side = kMargin_px + kCell_px * static_cast<int>(names.size());
  cv::Mat picture(side, side + kSummary_px, CV_8UC3, cv::Scalar(255, 255, 255));
  cv::Mat square = picture.colRange(0, side);
  writeNames(names, kCell_px, kMargin_px, square);
  for (std::size_t row = 0; row < names.size(); ++row) {
    drawRow(counts, names, row, kCell_px, kMargin_px, square);
    const int bottom = kMargin_px + (static_cast<int>(row) + 1) * kCell_px;
    writeSummary(counts, names, row, {side + 4, bottom - 2}, picture);
  }
  return picture;
}

double bytesPerView(const Index& index) {
  const auto bytes = static_cast<double>(index.bytes() - index.surfaceBytes());
  return index.viewCount() == 0 ? 0 : bytes / static_cast<double>(index.viewCount());
}

}  // namespace voxid::cli
