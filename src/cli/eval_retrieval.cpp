// SPDX-License-Identifier: BSD-3-Clause
#include "eval_retrieval.h"

#include <algorithm>
#include <cstdio>
#include <limits>
#include <set>

#include "float_distance.h"
#include "evaluation.h"
#include "retrieval.h"
#include "voxid/library/surface_points.h"
#include "whole_models.h"

namespace voxid::cli {
namespace {

using Numbers = std::vector<std::size_t>;

Numbers readable(const WholeModels& models) {
  Numbers numbers;
  for (std::size_t i = 0; i < models.names.size(); ++i) {
    if (models.reasons[i].empty()) numbers.push_back(i);
  }
  return numbers;
}

/// The readable models of `unseen` whose category the library has.
Numbers queriesOf(const WholeModels& unseen, const WholeModels& models, const Numbers& library) {
  std::set<std::string> taught;
  for (const std::size_t i : library) taught.insert(models.categories[i]);
  Numbers queries = readable(unseen);
  const auto foreign = [&](std::size_t i) { return taught.count(unseen.categories[i]) == 0; };
  queries.erase(std::remove_if(queries.begin(), queries.end(), foreign), queries.end());
  return queries;
}

/// The library, nearest first; equally far ones, and those without an answer at the end, by name.
Numbers rankedBy(const float* query, std::size_t descriptor, const WholeModels& models, const Numbers& library) {
  std::vector<std::pair<float, std::size_t>> order;
  for (const std::size_t i : library) {
    const bool answered = models.tables[descriptor]->hasAnswer(i);
    const float far = std::numeric_limits<float>::infinity();
    const int bins = kWholeDescriptors[descriptor].bins;
    order.emplace_back(answered ? l1OfFloats(query, models.bins(descriptor, i), bins) : far, i);
  }
  std::sort(order.begin(), order.end());
  Numbers ranked;
  for (const auto& [distance, i] : order) ranked.push_back(i);
  return ranked;
}

/// A query that the descriptor has no answer for finds nothing.
RetrievalScore ask(const WholeModels& unseen, std::size_t query, std::size_t descriptor, const WholeModels& models,
                   const Numbers& library) {
  if (!unseen.tables[descriptor]->hasAnswer(query)) return {};
  std::vector<bool> right;
  for (const std::size_t i : rankedBy(unseen.bins(descriptor, query), descriptor, models, library)) {
    right.push_back(models.categories[i] == unseen.categories[query]);
  }
  return scoreOf(right);
}

using Scores = std::vector<RetrievalScore>;

/// FIELD_minus_esf and its interval; null for ESF itself.
void addDifference(const std::string& field, const Scores& scores, const Scores& esf, double RetrievalScore::*figure,
                   Json& row) {
  const std::string name = field + "_minus_esf";
  row[name] = row[name + "_95"] = nullptr;
  if (row["descriptor"] == "esf") return;
  const MeanInterval difference = differenceOf(scores, esf, figure);
  row[name] = rounded(100 * difference.mean);
  row[name + "_95"] = Json::array({rounded(100 * difference.low), rounded(100 * difference.high)});
}

Json rowOf(const char* name, const Scores& scores, const Scores& esf) {
  const RetrievalScore mean = meanOf(scores);
  Json row;
  row["descriptor"] = name;
  row["nn"] = rounded(100 * mean.nn);
  row["tier1"] = rounded(100 * mean.tier1);
  row["tier2"] = rounded(100 * mean.tier2);
  row["map"] = rounded(100 * mean.map);
  addDifference("nn", scores, esf, &RetrievalScore::nn, row);
  addDifference("map", scores, esf, &RetrievalScore::map, row);
  return row;
}

void addSkipped(const std::string& folder, const WholeModels& models, Json& skipped) {
  for (std::size_t i = 0; i < models.names.size(); ++i) {
    if (models.reasons[i].empty()) continue;
    skipped.push_back({{"model", folder + "/" + models.names[i]}, {"reason", models.reasons[i]}});
  }
}

}  // namespace

Result<Json> evaluateRetrieval(const RetrievalOptions& options) {
  const auto models = describeWholeModels(options.models, options.params, options.jobs);
  if (!models.ok()) return models.status;
  const auto unseen = describeWholeModels(options.unseen, options.params, options.jobs);
  if (!unseen.ok()) return unseen.status;
  const Numbers library = readable(models.value), queries = queriesOf(unseen.value, models.value, library);
  if (queries.empty())
    return Status::nothingFound(options.unseen + ": no model of it is of a category of " + options.models);

  Json result;
  result["models"] = library.size();
  result["queries"] = queries.size();
  result["left_out"] = readable(unseen.value).size() - queries.size();
  result["points"] = kSurfacePoints;
  result["pairs"] = options.params.pairs;
  result["skipped"] = Json::array();
  addSkipped(options.models, models.value, result["skipped"]);
  addSkipped(options.unseen, unseen.value, result["skipped"]);
  result["rows"] = Json::array();
  std::array<Scores, kWholeDescriptors.size()> scores;
  for (std::size_t i = 0; i < scores.size(); ++i) {
    for (const std::size_t query : queries) scores[i].push_back(ask(unseen.value, query, i, models.value, library));
  }
  for (std::size_t i = 0; i < scores.size(); ++i) {
    result["rows"].push_back(rowOf(kWholeDescriptors[i].name, scores[i], scores.back()));
  }
  return result;
}

/// "+1.38 (0.72 to 2.05)"; nothing for ESF itself.
std::string differenceText(const Json& row, const std::string& name) {
  if (row[name].is_null()) return {};
  const Json& interval = row[name + "_95"];
  char text[64];
  std::snprintf(text, sizeof text, "%+.2f (%.2f to %.2f)", row[name].get<double>(), interval[0].get<double>(),
                interval[1].get<double>());
  return text;
}

void printRetrieval(const Json& result) {
  for (const Json& skipped : result["skipped"]) {
    std::printf("skipped %s: %s\n", skipped["model"].get<std::string>().c_str(),
                skipped["reason"].get<std::string>().c_str());
  }
  std::printf("%zu whole models asked for among %zu, %d points and %u lines each; figures in %%\n",
              result["queries"].get<std::size_t>(), result["models"].get<std::size_t>(), result["points"].get<int>(),
              result["pairs"].get<unsigned>());
  if (const auto left_out = result["left_out"].get<std::size_t>(); left_out > 0)
    std::printf("%zu left out: no model of their category is there\n", left_out);
  std::printf("%-11s %9s %11s %11s %6s %24s %22s\n", "descriptor", "nearest", "first tier", "second tier", "mAP",
              "nearest minus esf", "mAP minus esf");
  for (const Json& row : result["rows"]) {
    std::printf("%-11s %9.2f %11.2f %11.2f %6.2f %24s %22s\n", row["descriptor"].get<std::string>().c_str(),
                row["nn"].get<double>(), row["tier1"].get<double>(), row["tier2"].get<double>(),
                row["map"].get<double>(), differenceText(row, "nn_minus_esf").c_str(),
                differenceText(row, "map_minus_esf").c_str());
  }
}

}  // namespace voxid::cli
