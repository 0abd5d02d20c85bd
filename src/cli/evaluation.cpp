// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <random>

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

double bytesPerView(const Index& index) {
  const auto bytes = static_cast<double>(index.bytes() - index.surfaceBytes());
  return index.viewCount() == 0 ? 0 : bytes / static_cast<double>(index.viewCount());
}

}  // namespace voxid::cli
