// SPDX-License-Identifier: BSD-3-Clause
// voxid build: models become an index.
#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "command.h"
#include "voxid/library/builder.h"

namespace voxid::cli {
namespace {

using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

/// One object a line on stdout, at once. File names need not be UTF-8; JSON must.
void printEvent(const Json& event) {
  std::printf("%s\n", event.dump(-1, ' ', false, Json::error_handler_t::replace).c_str());
  std::fflush(stdout);
}

class JsonListener : public BuildListener {
 public:
  void onModel(const std::string& model, int views) override { printEvent({{"event", "model"}, {"model", model}, {"views", views}}); }
  void onSkipped(const SkippedModel& skipped) override {
    printEvent({{"event", "skipped"}, {"model", skipped.model}, {"reason", skipped.reason}});
  }
};

/// One line on a terminal, redrawn in place; nothing elsewhere.
class ProgressBar : public BuildListener {
 public:
  ~ProgressBar() override {
    if (drawn_) std::fprintf(stderr, "\r\033[K");
  }
  void onSkipped(const SkippedModel&) override { ++skipped_; }
  void onProgress(int done, int models, std::uint64_t views) override {
    if (!terminal_) return;
    drawn_ = true;
    const double seconds = std::chrono::duration<double>(Clock::now() - start_).count();
    const int left_s = done > 0 ? static_cast<int>(seconds * (models - done) / done) : 0;
    const int filled = models > 0 ? kWidth * done / models : 0;
    const std::string bar = std::string(static_cast<std::size_t>(filled), '#') + std::string(static_cast<std::size_t>(kWidth - filled), '.');
    std::fprintf(stderr, "\r\033[K[%s] %d/%d models, %.0f views/s, %d:%02d left, %d skipped", bar.c_str(), done, models,
                 static_cast<double>(views) / std::max(seconds, 0.001), left_s / 60, left_s % 60, skipped_);
  }

 private:
  static constexpr int kWidth = 30;
  bool terminal_ = ::isatty(STDERR_FILENO) == 1, drawn_ = false;
  int skipped_ = 0;
  Clock::time_point start_ = Clock::now();
};

void printSkipped(const BuildReport& report) {
  for (const SkippedModel& skipped : report.skipped) {
    std::fprintf(stderr, "voxid: skipped %s: %s\n", skipped.model.c_str(), skipped.reason.c_str());
  }
  for (const std::string& category : report.empty_categories) {
    std::fprintf(stderr, "voxid: category %s has no readable mesh and is left out\n", category.c_str());
  }
}

void printDone(const BuildReport& report, const std::string& out) {
  std::fprintf(stderr, "voxid: %s: %d views of %d models in %d categories, %llu bytes; %zu skipped\n", out.c_str(), report.views,
               report.models, report.categories, static_cast<unsigned long long>(report.bytes), report.skipped.size());
}

void printDoneEvent(const BuildReport& report) {
  Json skipped = Json::array();
  for (const SkippedModel& one : report.skipped) skipped.push_back({{"model", one.model}, {"reason", one.reason}});
  printEvent({{"event", "done"},
              {"models", report.models},
              {"views", report.views},
              {"categories", report.categories},
              {"skipped", skipped},
              {"empty_categories", report.empty_categories},
              {"calibration_samples", report.calibration_samples},
              {"bytes", report.bytes}});
}

Status run(const BuildOptions& options, bool json) {
  ::signal(SIGXFSZ, SIG_IGN);  // a file size limit is then an error of write(), with a sentence
  Result<BuildReport> report = Status::cannotDo("not built");
  if (json) {
    JsonListener listener;
    report = buildIndex(options, listener);
  } else {
    ProgressBar listener;
    report = buildIndex(options, listener);
  }
  if (!report.ok()) return report.status;
  printSkipped(report.value);
  if (json) printDoneEvent(report.value);
  else printDone(report.value, options.out);
  return {};
}

int processors() { return std::max(1, static_cast<int>(std::thread::hardware_concurrency())); }

}  // namespace

Run addBuild(CLI::App& app) {
  auto options = std::make_shared<BuildOptions>();
  auto json = std::make_shared<bool>(false);
  options->jobs = processors();
  app.add_option("--models", options->models, "Folder with one folder a category, which holds a mesh file a model")->required();
  app.add_option("--out", options->out, "The index to write (.vxi); an old one stays until the new one is whole")->required();
  app.add_option("--jobs", options->jobs, "Worker processes; the index is the same for any number")->capture_default_str()->check(CLI::Range(1, 1024));
  app.add_flag("--resume", options->resume, "Go on where an interrupted build of the same models and settings ended");
  app.add_option("--views-every", options->views_every, "Take every n-th of the 80 directions")->capture_default_str()->check(CLI::Range(1, 80));
  app.add_option("--pairs", options->params.pairs, "Lines a descriptor; a query uses what its index used")->capture_default_str()->check(CLI::Range(1, 1000000));
  app.add_flag("--json", *json, "Events as JSON, one a line on standard output");
  return [options, json] { return run(*options, *json); };
}

}  // namespace voxid::cli
