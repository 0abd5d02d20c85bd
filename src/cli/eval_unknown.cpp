// SPDX-License-Identifier: BSD-3-Clause
#include "eval_unknown.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <numeric>
#include <thread>

#include "evaluation.h"
#include "nearest_codes.h"
#include "recogniser.h"
#include "reliability.h"
#include "voxid/core/crc32c.h"

namespace voxid::cli {
namespace {

constexpr int kFolds = 4;
constexpr std::array<int, 3> kRisksPercent{5, 10, 20};

int foldOf(std::string_view category) { return static_cast<int>(crc32c(category.data(), category.size()) % kFolds); }

AllowedCategories allWithout(const Index& index, int fold) {
  AllowedCategories allowed(index.categories().size);
  for (std::uint32_t i = 0; i < allowed.size(); ++i) allowed[i] = foldOf(index.categoryName(i)) != fold;
  return allowed;
}

/// From the whole index, and by the fold that is left out of it.
struct Answered {
  Judged closed;
  std::array<Judged, kFolds> open;
};

/// One object a thread.
class Examiner {
 public:
  Examiner(const Index& index, const CameraChoice& camera)
      : index_(index),
        camera_(camera),
        code_(ownCode(index)),
        views_(index.viewCount()),
        search_(index, *code_, allViews(),
                [&index](std::size_t view) { return index.code(static_cast<std::uint32_t>(view)); }) {
    for (int fold = 0; fold < kFolds; ++fold) allowed_.push_back(allWithout(index, fold));
  }

  Status answer(const Query& query, Answered& answered) {
    const auto file = readDepthFile(query.path, camera_);
    if (!file.ok()) return file.status;
    const DepthView depth = file.value.view();
    const std::vector<std::uint32_t> pixels = setPixels(depth);
    answered.closed = judge(query, depth, pixels, {});
    for (std::size_t fold = 0; fold < allowed_.size(); ++fold)
      answered.open[fold] = judge(query, depth, pixels, allowed_[fold]);
    return {};
  }

 private:
  std::vector<std::uint32_t> allViews() {
    std::iota(views_.begin(), views_.end(), 0u);
    return views_;
  }

  Judged judge(const Query& query, const DepthView& depth, const std::vector<std::uint32_t>& pixels,
               const AllowedCategories& allowed) {
    const Nearest* const found = search_.find(depth, {pixels.data(), pixels.size()}, allowed);
    if (found == nullptr || found->views.empty()) return {};
    const Answer answer = classify(index_, *found, ClassifyMethod::Vote, 0);
    return {answer.score_permille / 1000.0, index_.categoryName(answer.alternatives[0].category) == query.category};
  }

  const Index& index_;
  CameraChoice camera_;
  std::unique_ptr<ViewCode> code_;
  std::vector<std::uint32_t> views_;
  CodeSearch search_;
  std::vector<AllowedCategories> allowed_;
};

/// Fails with the first query, in their order, that cannot be answered.
Result<std::vector<Answered>> answerAll(const Index& index, const std::vector<Query>& queries,
                                        const CameraChoice& camera, int jobs) {
  std::vector<Answered> answered(queries.size());
  std::vector<Status> statuses(queries.size());
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    Examiner examiner(index, camera);
    for (std::size_t i = next++; i < queries.size(); i = next++) statuses[i] = examiner.answer(queries[i], answered[i]);
  };
  std::vector<std::thread> threads;
  for (int i = 1; i < jobs; ++i) threads.emplace_back(work);
  work();
  for (std::thread& thread : threads) thread.join();
  const auto failed = std::find_if(statuses.begin(), statuses.end(), [](const Status& s) { return !s.ok(); });
  if (failed != statuses.end()) return *failed;
  return answered;
}

/// One fold: right answers, and answers to queries whose category is left out.
struct Fold {
  std::vector<double> right, strangers;
};

Fold foldFigures(const std::vector<Query>& queries, const std::vector<Answered>& answered, int fold) {
  Fold figures;
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const Judged& judged = answered[i].open[static_cast<std::size_t>(fold)];
    if (foldOf(queries[i].category) == fold)
      figures.strangers.push_back(judged.said);
    else if (judged.right)
      figures.right.push_back(judged.said);
  }
  return figures;
}

double fourDecimals(double x) { return std::round(x * 10000) / 10000; }

Json coverageOf(const std::vector<RiskPoint>& curve) {
  Json coverage;
  for (const int risk : kRisksPercent) coverage[std::to_string(risk)] = fourDecimals(coverageAt(curve, risk / 100.0));
  return coverage;
}

Json binsOf(const std::vector<Bin>& bins) {
  Json list = Json::array();
  for (const Bin& bin : bins)
    list.push_back({{"said", fourDecimals(bin.said)}, {"seen", fourDecimals(bin.seen)}, {"answers", bin.answers}});
  return list;
}

/// The mean over the folds, and each of them.
void addFolds(const std::vector<Query>& queries, const std::vector<Answered>& answered, Json& json) {
  double sum = 0;
  Json folds = Json::array();
  for (int fold = 0; fold < kFolds; ++fold) {
    const Fold figures = foldFigures(queries, answered, fold);
    const double area = areaUnderCurve(figures.right, figures.strangers);
    folds.push_back({{"left_out", figures.strangers.size()}, {"auc", fourDecimals(area)}});
    sum += area;
  }
  json["auc_left_out"] = fourDecimals(sum / kFolds);
  json["folds"] = std::move(folds);
}

Status checkModels(const Index& index, const std::string& models) {
  for (std::uint32_t i = 0; i < index.categories().size && !models.empty(); ++i) {
    const std::string name(index.categoryName(i));
    if (!std::filesystem::is_directory(std::filesystem::path(models) / name))
      return Status::cannotDo(models + ": has no folder " + name + "; expected the folder that " + index.path() +
                              " was made from, or no --models");
  }
  return {};
}

}  // namespace

Result<Json> evaluateUnknown(const std::shared_ptr<const Index>& index, const std::vector<Query>& queries,
                             const CameraChoice& camera, const UnknownOptions& options) {
  if (Status status = checkModels(*index, options.models); !status.ok()) return status;
  const auto answered = answerAll(*index, queries, camera, options.jobs);
  if (!answered.ok()) return answered.status;
  std::vector<Judged> closed, open;
  std::size_t right = 0;
  for (const Answered& one : answered.value) {
    closed.push_back(one.closed);
    open.insert(open.end(), one.open.begin(), one.open.end());
    right += one.closed.right;
  }
  const auto bins = reliabilityOf(closed);
  const auto closed_curve = riskCoverage(closed), open_curve = riskCoverage(open);
  const format::Confidence* const learnt = index->confidence();
  Json json;
  json["queries"] = queries.size();
  json["accuracy"] = fourDecimals(static_cast<double>(right) / static_cast<double>(queries.size()));
  json["accuracy_to_expect"] = learnt ? Json(fourDecimals(1.0 * learnt->right / learnt->samples)) : Json(nullptr);
  json["ece"] = fourDecimals(calibrationError(bins));
  json["auc_wrong"] = fourDecimals(areaUnderCurve(closed));
  addFolds(queries, answered.value, json);
  json["coverage"] = coverageOf(closed_curve);
  json["coverage_left_out"] = coverageOf(open_curve);
  json["reliability"] = binsOf(bins);
  if (options.plot.empty()) return json;
  const Status drawn = writeImage(options.plot, drawReliability(bins, closed_curve, open_curve));
  if (!drawn.ok()) return drawn;
  return json;
}

void printUnknown(const Json& result) {
  std::printf("%zu queries, %.1f %% named rightly", result["queries"].get<std::size_t>(),
              100 * result["accuracy"].get<double>());
  if (!result["accuracy_to_expect"].is_null())
    std::printf(" (%.1f %% foretold by the index)", 100 * result["accuracy_to_expect"].get<double>());
  std::printf(
      "\ncalibration error %.2f points; area under the curve, right against wrong: %.3f, right against left-out "
      "categories: %.3f\n",
      100 * result["ece"].get<double>(), result["auc_wrong"].get<double>(), result["auc_left_out"].get<double>());
  std::printf("at a risk of      answered      with a quarter of the categories left out\n");
  for (const int risk : kRisksPercent) {
    const std::string key = std::to_string(risk);
    std::printf("%9d %% %13.1f %% %12.1f %%\n", risk, 100 * result["coverage"][key].get<double>(),
                100 * result["coverage_left_out"][key].get<double>());
  }
  std::printf("said, seen:");
  for (const Json& bin : result["reliability"])
    std::printf("  %.0f:%.0f", 100 * bin["said"].get<double>(), 100 * bin["seen"].get<double>());
  std::printf("\n");
}

}  // namespace voxid::cli
