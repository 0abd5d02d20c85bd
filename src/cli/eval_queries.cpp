// SPDX-License-Identifier: BSD-3-Clause
#include "eval_queries.h"

#include <atomic>
#include <chrono>
#include <mutex>
#include <thread>

namespace voxid::cli {
namespace {

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// Answers one query after the other, as long as there are any; one object a thread.
class Examiner {
 public:
  Examiner(std::shared_ptr<const Index> index, const std::vector<Query>& queries, const CameraChoice& camera,
           const SearchChoice& search, Outcomes& outcomes)
      : recogniser_(std::move(index), search), camera_(camera), queries_(queries), outcomes_(outcomes) {}

  Status answer(std::size_t query) {
    const auto file = readDepthFile(queries_[query].path, camera_);
    if (!file.ok()) return file.status;
    const std::vector<std::uint32_t> pixels = setPixels(file.value.view());
    const Clock::time_point start = Clock::now();
    const Nearest* const found = recogniser_.nearest(file.value.view(), {pixels.data(), pixels.size()});
    const double search_s = secondsSince(start);
    for (std::size_t m = 0; m < kMethods.size(); ++m) rank(query, m, found, search_s);
    return {};
  }

 private:
  void rank(std::size_t query, std::size_t method, const Nearest* found, double search_s) {
    const Clock::time_point start = Clock::now();
    const Answer answer = found ? classify(recogniser_.index(), *found, kMethods[method].method, 0) : Answer{};
    const double seconds = search_s + secondsSince(start);
    Outcome outcome = outcomeOf(recogniser_.index(), answer, queries_[query].category);
    outcome.seconds = seconds;
    outcomes_[method][query] = std::move(outcome);
  }

  Recogniser recogniser_;
  CameraChoice camera_;
  const std::vector<Query>& queries_;
  Outcomes& outcomes_;
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

Result<Outcomes> answerAll(const std::shared_ptr<const Index>& index, const std::vector<Query>& queries,
                           const CameraChoice& camera, const SearchChoice& search, int jobs) {
  Outcomes outcomes;
  for (auto& list : outcomes) list.resize(queries.size());
  Failure failure;
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    Examiner examiner(index, queries, camera, search, outcomes);
    for (std::size_t query = next++; query < queries.size(); query = next++) {
      Status status = examiner.answer(query);
      if (!status.ok()) return failure.report(query, std::move(status));
    }
  };
  std::vector<std::thread> threads;
  for (int i = 1; i < jobs; ++i) threads.emplace_back(work);
  work();
  for (std::thread& thread : threads) thread.join();
  if (!failure.status.ok()) return failure.status;
  return outcomes;
}

double bytesPerView(const Index& index) {
  return static_cast<double>(index.bytes()) / static_cast<double>(index.viewCount());
}

Json resultOf(const Index& index, const std::vector<Query>& queries, const Outcomes& outcomes) {
  Json json;
  json["queries"] = queries.size();
  json["rows"] = Json::array();
  for (std::size_t m = 0; m < kMethods.size(); ++m) {
    json["rows"].push_back(
        rowOf(index.parameters().profile, kMethods[m].name, figuresOf(queries, outcomes[m]), bytesPerView(index)));
  }
  return json;
}

}  // namespace

Result<QueryEvaluation> evaluateQueries(const std::shared_ptr<const Index>& index, const std::vector<Query>& queries,
                                        const CameraChoice& camera, const SearchChoice& search, int jobs) {
  const auto outcomes = answerAll(index, queries, camera, search, jobs);
  if (!outcomes.ok()) return outcomes.status;
  return QueryEvaluation{resultOf(*index, queries, outcomes.value), outcomes.value.back()};
}

}  // namespace voxid::cli
