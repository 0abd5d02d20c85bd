// SPDX-License-Identifier: BSD-3-Clause
#include "eval_queries.h"

#include <atomic>
#include <chrono>
#include <cmath>
#include <mutex>
#include <thread>

#include "look_alikes.h"

namespace voxid::cli {
namespace {

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

struct AllOutcomes {
  Outcomes by_method;
  std::vector<Outcome> aligned;  ///< empty if alignment is no evidence
};

/// Answers one query after the other, as long as there are any; one object a thread.
class Examiner {
 public:
  Examiner(const std::shared_ptr<const Index>& index, const std::vector<Query>& queries, const CameraChoice& camera,
           const QueryOptions& options, AllOutcomes& outcomes)
      : recogniser_(index, options.search, options.evidence, options.models),
        camera_(camera),
        queries_(queries),
        outcomes_(outcomes) {}

  Status answer(std::size_t query) {
    const auto file = readDepthFile(queries_[query].path, camera_);
    if (!file.ok()) return file.status;
    const std::vector<std::uint32_t> pixels = setPixels(file.value.view());
    const ObservedObject object{file.value.view(), {pixels.data(), pixels.size()}, {}};
    const Clock::time_point start = Clock::now();
    const Nearest* const found = recogniser_.nearest(object);
    const double search_s = secondsSince(start);
    for (std::size_t m = 0; m < kMethods.size(); ++m) {
      outcomes_.by_method[m][query] = outcomeBy(query, search_s, [&] {
        return found ? classify(recogniser_.index(), *found, kMethods[m].method, 0) : Answer{};
      });
    }
    return outcomes_.aligned.empty() || found == nullptr ? Status() : align(query, object, *found, search_s);
  }

 private:
  /// Reading the models is not counted: a robot has read them before.
  Status align(std::size_t query, const ObservedObject& object, const Nearest& found, double search_s) {
    auto candidates = recogniser_.candidates(found);
    if (!candidates.ok()) return candidates.status;
    outcomes_.aligned[query] = outcomeBy(query, search_s, [&] {
      recogniser_.naming().sketch(object, candidates.value);
      return recogniser_.naming().name(found, candidates.value, 0);
    });
    return {};
  }

  template <typename Rank>
  Outcome outcomeBy(std::size_t query, double search_s, Rank rank) {
    const Clock::time_point start = Clock::now();
    const Answer answer = rank();
    const double seconds = search_s + secondsSince(start);
    Outcome outcome = outcomeOf(recogniser_.index(), answer, queries_[query].category);
    outcome.seconds = seconds;
    return outcome;
  }

  EvidenceRecogniser recogniser_;
  CameraChoice camera_;
  const std::vector<Query>& queries_;
  AllOutcomes& outcomes_;
};

/// The first failure in the order of the queries, so that the sentence does not depend on the threads.
struct Failure {
  std::mutex mutex;
  std::size_t query = SIZE_MAX;
  Status status;

  void report(std::size_t failed, Status why) {
    const std::lock_guard<std::mutex> lock(mutex);
    if (failed >= query) return;
    query = failed;
    status = std::move(why);
  }
};

Result<AllOutcomes> answerAll(const std::shared_ptr<const Index>& index, const std::vector<Query>& queries,
                              const CameraChoice& camera, const QueryOptions& options) {
  AllOutcomes outcomes;
  for (auto& list : outcomes.by_method) list.resize(queries.size());
  if (options.evidence.align()) outcomes.aligned.resize(queries.size());
  Failure failure;
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    Examiner examiner(index, queries, camera, options, outcomes);
    for (std::size_t query = next++; query < queries.size(); query = next++) {
      Status status = examiner.answer(query);
      if (!status.ok()) return failure.report(query, std::move(status));
    }
  };
  std::vector<std::thread> threads;
  for (int i = 1; i < options.jobs; ++i) threads.emplace_back(work);
  work();
  for (std::thread& thread : threads) thread.join();
  if (!failure.status.ok()) return failure.status;
  return outcomes;
}

Json alignedRow(const Index& index, const std::vector<Query>& queries, const AllOutcomes& outcomes) {
  Json row = rowOf(index.parameters().profile, "align", figuresOf(queries, outcomes.aligned), bytesPerView(index));
  const Difference difference = differenceOf(queries, outcomes.aligned, outcomes.by_method.back());
  row["minus_vote"] = rounded(difference.top1);
  row["minus_vote_95"] = {rounded(difference.low), rounded(difference.high)};
  return row;
}

/// What answers are worth as synsets instead of categories.
Json levelsOf(const Index& index, const std::vector<Query>& queries, const std::vector<Outcome>& outcomes) {
  const SynsetPaths paths = synsetPathsOf(index);
  if (paths.empty()) return nullptr;
  int same = 0, told = 0, right = 0, mistaken = 0, saved = 0;
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const Outcome& outcome = outcomes[i];
    const auto truth = paths.find(queries[i].category);
    const bool holds = !outcome.coarse.empty() && truth != paths.end() &&
                       truth->second.find("/" + outcome.coarse + "/") != std::string::npos;
    const bool wrong = outcome.label != queries[i].category;
    same += sameOrAbove(paths, queries[i].category, outcome.label);
    told += !outcome.coarse.empty();
    right += holds;
    mistaken += wrong && !outcome.coarse.empty();
    saved += wrong && holds;
  }
  const auto share = [](int part, int whole) {
    return whole == 0 ? Json(nullptr) : Json(std::round(10000.0 * part / whole) / 100);
  };
  const int all = static_cast<int>(queries.size());
  return {{"synset_top1", share(same, all)},
          {"told", share(told, all)},
          {"told_right", share(right, told)},
          {"told_but_category_wrong", share(mistaken, all)},
          {"right_of_these", share(saved, mistaken)}};
}

Json resultOf(const Index& index, const std::vector<Query>& queries, const AllOutcomes& outcomes) {
  Json json;
  json["queries"] = queries.size();
  json["rows"] = Json::array();
  for (std::size_t m = 0; m < kMethods.size(); ++m) {
    json["rows"].push_back(rowOf(index.parameters().profile, kMethods[m].name,
                                 figuresOf(queries, outcomes.by_method[m]), bytesPerView(index)));
  }
  if (!outcomes.aligned.empty()) json["rows"].push_back(alignedRow(index, queries, outcomes));
  json["levels"] = levelsOf(index, queries, outcomes.by_method.back());
  return json;
}

}  // namespace

Result<QueryEvaluation> evaluateQueries(const std::shared_ptr<const Index>& index, const std::vector<Query>& queries,
                                        const CameraChoice& camera, const QueryOptions& options) {
  const auto answered = answerAll(index, queries, camera, options);
  if (!answered.ok()) return answered.status;
  const AllOutcomes& outcomes = answered.value;
  return QueryEvaluation{resultOf(*index, queries, outcomes),
                         outcomes.aligned.empty() ? outcomes.by_method.back() : outcomes.aligned};
}

}  // namespace voxid::cli
