// SPDX-License-Identifier: BSD-3-Clause
// voxid eval: how well an index names labelled queries.
#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <memory>
#include <mutex>
#include <thread>

#include "command.h"
#include "depth_file.h"
#include "evaluation.h"
#include "recogniser.h"

namespace voxid::cli {
namespace {

struct Options {
  std::string index, queries, confusion;
  SearchChoice search;
  int every = 1, jobs = 1;
  bool json = false;
};

struct Method {
  const char* name;
  ClassifyMethod method;
};
constexpr std::array<Method, 2> kMethods{{{"1nn", ClassifyMethod::OneNn}, {"vote", ClassifyMethod::Vote}}};

/// Outcomes by method, then by query.
using Outcomes = std::array<std::vector<Outcome>, kMethods.size()>;
using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

Outcome outcomeOf(const Index& index, const Answer& answer, const std::string& category) {
  Outcome outcome;
  for (int i = 0; i < std::min(answer.count, 5); ++i) {
    const std::string_view label = index.categoryName(answer.alternatives[static_cast<std::size_t>(i)].category);
    if (i == 0) outcome.label = std::string(label);
    outcome.in_five |= label == category;
  }
  return outcome;
}

/// Answers one query after the other, as long as there are any; one object a thread.
class Examiner {
 public:
  Examiner(const Options& options, std::shared_ptr<const Index> index, const std::vector<Query>& queries,
           Outcomes& outcomes)
      : recogniser_(std::move(index), options.search),
        camera_(cameraOfFolder(options.queries)),
        queries_(queries),
        outcomes_(outcomes) {}

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

Result<Outcomes> answerAll(const Options& options, const std::shared_ptr<const Index>& index,
                           const std::vector<Query>& queries) {
  Outcomes outcomes;
  for (auto& list : outcomes) list.resize(queries.size());
  Failure failure;
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    Examiner examiner(options, index, queries, outcomes);
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

double rounded(double x) { return std::round(x * 100) / 100; }

Json rowOf(const Index& index, const char* method, const Figures& figures) {
  Json row;
  row["descriptor"] = index.parameters().profile;
  row["method"] = method;
  row["top1"] = rounded(figures.top1);
  row["mean_category"] = rounded(figures.mean_category);
  row["top5"] = rounded(figures.top5);
  row["us_per_query"] = rounded(figures.us_per_query);
  row["bytes_per_view"] = rounded(static_cast<double>(index.bytes()) / static_cast<double>(index.views().size));
  row["top1_95"] = Json::array({rounded(figures.top1_low), rounded(figures.top1_high)});
  return row;
}

Json resultOf(const Index& index, const std::vector<Query>& queries, const Outcomes& outcomes) {
  Json json;
  json["queries"] = queries.size();
  json["rows"] = Json::array();
  for (std::size_t m = 0; m < kMethods.size(); ++m) {
    json["rows"].push_back(rowOf(index, kMethods[m].name, figuresOf(queries, outcomes[m])));
  }
  return json;
}

void printTable(const Json& result) {
  std::printf("%zu queries; accuracies in %%, top-1 with its 95 %% interval over the models\n",
              result["queries"].get<std::size_t>());
  std::printf("%-10s %-6s %6s %17s %9s %6s %10s %11s\n", "descriptor", "method", "top-1", "", "mean cat.", "top-5",
              "us/query", "bytes/view");
  for (const Json& row : result["rows"]) {
    char interval[32];
    std::snprintf(interval, sizeof interval, "(%.2f to %.2f)", row["top1_95"][0].get<double>(),
                  row["top1_95"][1].get<double>());
    std::printf("%-10s %-6s %6.2f %17s %9.2f %6.2f %10.0f %11.1f\n", row["descriptor"].get<std::string>().c_str(),
                row["method"].get<std::string>().c_str(), row["top1"].get<double>(), interval,
                row["mean_category"].get<double>(), row["top5"].get<double>(), row["us_per_query"].get<double>(),
                row["bytes_per_view"].get<double>());
  }
}

Status run(const Options& options) {
  const auto index = Index::open(options.index);
  if (!index.ok()) return index.status;
  const auto queries = readQueries(options.queries, options.every);
  if (!queries.ok()) return queries.status;
  const auto outcomes = answerAll(options, index.value, queries.value);
  if (!outcomes.ok()) return outcomes.status;
  const Json result = resultOf(*index.value, queries.value, outcomes.value);
  if (options.json) {
    std::cout << lineOf(result);
  } else {
    printTable(result);
  }
  if (options.confusion.empty()) return {};
  return writeImage(options.confusion, drawConfusion(queries.value, outcomes.value.back()));
}

}  // namespace

Run addEval(CLI::App& app) {
  const auto options = std::make_shared<Options>();
  app.add_option("--index", options->index, "The index (.vxi) to measure")->type_name("FILE")->required();
  app.add_option("--queries", options->queries,
                 "Depth images of one object each, with queries.csv (file,category,model)")
      ->type_name("DIR")
      ->required();
  app.add_option("--every", options->every, "Take each N-th query only")->type_name("N")->check(CLI::Range(1, 1000000));
  app.add_option("--jobs", options->jobs,
                 "Threads; more finish sooner, but a query's time is measured best with 1, the default")
      ->type_name("N")
      ->check(CLI::Range(1, 256));
  options->search.addTo(app);
  app.add_flag("--json", options->json, "One JSON object");
  app.add_option("--confusion", options->confusion, "Draw which category was taken for which (method vote)")
      ->type_name("PATH.png");
  return [options] { return run(*options); };
}

}  // namespace voxid::cli
