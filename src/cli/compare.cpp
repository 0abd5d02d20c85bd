// SPDX-License-Identifier: BSD-3-Clause
#include "compare.h"

#include "compare_views.h"
#include "cpu_time.h"
#include "evaluation.h"
#include "nearest_codes.h"
#include "projected_esf.h"
#include "recogniser.h"

namespace voxid::cli {
namespace {

/// All queries by one descriptor.
class Comparison {
 public:
  Comparison(const Index& index, CodeSearch search, std::size_t queries) : index_(index), search_(std::move(search)) {
    for (auto& outcomes : outcomes_) outcomes.resize(queries);
  }

  void answer(std::size_t number, const Query& query, const DepthView& depth, Span<const std::uint32_t> pixels) {
    const Nearest* found = nullptr;
    const double search_us = usOf([&] { found = search_.find(depth, pixels); });
    for (std::size_t m = 0; m < kMethods.size(); ++m) {
      Answer answer;
      const double rank_us = usOf([&] {
        if (found != nullptr) answer = classify(index_, *found, kMethods[m].method, 0);
      });
      outcomes_[m][number] = outcomeOf(index_, answer, query.category);
      outcomes_[m][number].seconds = (search_us + rank_us) * 1e-6;
    }
  }

  const ViewCode& code() const { return search_.code(); }
  const Outcomes& outcomes() const { return outcomes_; }

 private:
  const Index& index_;
  CodeSearch search_;
  Outcomes outcomes_;
};

std::vector<Json> rowsOf(const Comparison& ours, const Comparison& esf, const std::vector<Query>& queries) {
  std::vector<Json> rows;
  for (std::size_t m = 0; m < kMethods.size(); ++m) {
    const Figures figures = figuresOf(queries, ours.outcomes()[m]);
    Json row = rowOf(ours.code().name, kMethods[m].name, figures, static_cast<double>(ours.code().bytes));
    const Difference difference = differenceOf(queries, ours.outcomes()[m], esf.outcomes()[m]);
    row["minus_esf"] = rounded(difference.top1);
    row["minus_esf_95"] = Json::array({rounded(difference.low), rounded(difference.high)});
    if (&ours == &esf) row["minus_esf"] = row["minus_esf_95"] = nullptr;
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace

Result<Json> compareDescriptors(const std::shared_ptr<const Index>& index, const std::vector<Query>& queries,
                                const CameraChoice& camera, const CompareOptions& options) {
  auto compared = describeViews(*index, options.models, options.every, options.jobs);
  if (!compared.ok()) return compared.status;
  auto codes = comparedCodes(*index);
  if (index->projection()) {
    ProjectedEsf projected = projectEsf(*index, compared.value.views, *compared.value.tables[0]);
    codes.insert(codes.begin() + 1, std::move(projected.code));
    compared.value.tables.insert(compared.value.tables.begin() + 1, std::move(projected.table));
  }
  std::vector<Comparison> comparisons;
  for (std::size_t i = 0; i < codes.size(); ++i) {
    CodeSearch search(*index, *codes[i], compared.value.views, compared.value.codesOf(i));
    comparisons.emplace_back(*index, std::move(search), queries.size());
  }
  for (std::size_t number = 0; number < queries.size(); ++number) {
    const auto file = readDepthFile(queries[number].path, camera);
    if (!file.ok()) return file.status;
    const std::vector<std::uint32_t> pixels = setPixels(file.value.view());
    for (Comparison& comparison : comparisons) {
      comparison.answer(number, queries[number], file.value.view(), {pixels.data(), pixels.size()});
    }
  }
  Json json;
  json["queries"] = queries.size();
  json["views"] = compared.value.views.size();
  json["every"] = options.every;
  json["rows"] = Json::array();
  for (const Comparison& comparison : comparisons) {
    for (Json& row : rowsOf(comparison, comparisons[0], queries)) json["rows"].push_back(std::move(row));
  }
  return json;
}

}  // namespace voxid::cli
