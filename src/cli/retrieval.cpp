// SPDX-License-Identifier: BSD-3-Clause
#include "retrieval.h"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <random>

namespace voxid::cli {
namespace {

double rightAmong(const std::vector<bool>& right, std::ptrdiff_t first) {
  const auto end = right.begin() + std::min(first, static_cast<std::ptrdiff_t>(right.size()));
  return static_cast<double>(std::count(right.begin(), end, true));
}

double averagePrecision(const std::vector<bool>& right) {
  double found = 0, sum = 0;
  for (std::size_t i = 0; i < right.size(); ++i) {
    if (!right[i]) continue;
    ++found;
    sum += found / static_cast<double>(i + 1);
  }
  return sum / found;
}

/// The mean of as many values, drawn with replacement.
double meanOfDrawn(const std::vector<double>& values, std::mt19937_64& generator) {
  double sum = 0;
  for (std::size_t i = 0; i < values.size(); ++i) sum += values[generator() % values.size()];
  return sum / static_cast<double>(values.size());
}

}  // namespace

RetrievalScore scoreOf(const std::vector<bool>& right) {
  const std::ptrdiff_t c = std::count(right.begin(), right.end(), true);
  const auto all = static_cast<double>(c);
  return {right.front() ? 1.0 : 0.0, rightAmong(right, c) / all, rightAmong(right, 2 * c) / all,
          averagePrecision(right)};
}

RetrievalScore meanOf(const std::vector<RetrievalScore>& scores) {
  RetrievalScore mean;
  const double n = std::max<double>(1, static_cast<double>(scores.size()));
  for (const RetrievalScore& score : scores) {
    mean.nn += score.nn / n;
    mean.tier1 += score.tier1 / n;
    mean.tier2 += score.tier2 / n;
    mean.map += score.map / n;
  }
  return mean;
}

MeanInterval differenceOf(const std::vector<RetrievalScore>& ours, const std::vector<RetrievalScore>& theirs,
                          double RetrievalScore::*figure) {
  constexpr std::size_t kResamplings = 2000;
  std::vector<double> differences, means;
  for (std::size_t i = 0; i < ours.size(); ++i) differences.push_back(ours[i].*figure - theirs[i].*figure);
  std::mt19937_64 generator(1);
  while (means.size() < kResamplings) means.push_back(meanOfDrawn(differences, generator));
  std::sort(means.begin(), means.end());
  const double sum = std::accumulate(differences.begin(), differences.end(), 0.0);
  return {sum / static_cast<double>(differences.size()), means[kResamplings / 40],
          means[kResamplings - 1 - kResamplings / 40]};
}

}  // namespace voxid::cli
