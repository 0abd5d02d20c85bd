// SPDX-License-Identifier: BSD-3-Clause
// What answers to labelled queries amount to.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "queries.h"
#include "scene_json.h"
#include "voxid/core/classifier.h"

namespace voxid::cli {

/// The answer to one query.
struct Outcome {
  std::string label;     ///< the first category; empty if nothing could be compared
  bool in_five = false;  ///< the right category is among the first five
  std::string coarse;    ///< the synset that can be told (coarse.h); empty if none
  double seconds = 0;    ///< describing, searching and ranking
};

/// How neighbours become an answer.
struct Method {
  const char* name;
  ClassifyMethod method;
};
constexpr std::array<Method, 2> kMethods{{{"1nn", ClassifyMethod::OneNn}, {"vote", ClassifyMethod::Vote}}};

/// Outcomes by method, then by query.
using Outcomes = std::array<std::vector<Outcome>, kMethods.size()>;

/// The answer held against the right category.
Outcome outcomeOf(const Index& index, const Answer& answer, const std::string& category);

/// Accuracies in percent.
struct Figures {
  double top1 = 0;                     ///< queries whose first category is right
  double mean_category = 0;            ///< top1 of each category, averaged over the categories
  double top5 = 0;                     ///< queries with the right category among the first five
  double top1_low = 0, top1_high = 0;  ///< 95 % of top1 over 2,000 resamplings of the models (fixed seed)
  double us_per_query = 0;             ///< mean; reading the image is not counted
};

/// `outcomes` by query, at least one.
Figures figuresOf(const std::vector<Query>& queries, const std::vector<Outcome>& outcomes);

/// A row of `voxid eval`.
Json rowOf(const std::string& descriptor, const char* method, const Figures& figures, double bytes_per_view);

/// top1 of `ours` minus that of `theirs`, in points, with 95 % of it over 2,000 resamplings of the models, both drawn
/// together.
struct Difference {
  double top1 = 0, low = 0, high = 0;
};
Difference differenceOf(const std::vector<Query>& queries, const std::vector<Outcome>& ours,
                        const std::vector<Outcome>& theirs);

/// Two decimals.
double rounded(double x);

/// Of an index; the surfaces that it keeps grow with the models and are not counted.
double bytesPerView(const Index& index);

}  // namespace voxid::cli
