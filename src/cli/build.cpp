// SPDX-License-Identifier: BSD-3-Clause
// voxid build: models become an index.
#include <signal.h>

#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>

#include "build_progress.h"
#include "command.h"
#include "voxid/library/builder.h"
#include "voxid/library/shipped_projection.h"

namespace voxid::cli {
namespace {

using Json = nlohmann::ordered_json;

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

void printEmpty(const BuildReport& report) {
  for (const std::string& category : report.empty_categories) {
    std::fprintf(stderr, "voxid: category %s has no readable mesh and is left out\n", category.c_str());
  }
}

void printDone(const BuildReport& report, const std::string& out) {
  std::fprintf(stderr, "voxid: %s: %d views of %d models in %d categories, %llu bytes; %zu skipped\n", out.c_str(), report.views,
               report.models, report.categories, static_cast<unsigned long long>(report.bytes), report.skipped.size());
}

double accuracyToExpect(const format::Confidence& confidence) {
  return static_cast<double>(confidence.right) / confidence.samples;
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
              {"accuracy_to_expect", report.confidence ? Json(accuracyToExpect(*report.confidence)) : Json(nullptr)},
              {"bytes", report.bytes}});
}

/// Which descriptor, as options.
struct DescriptorChoice {
  std::string descriptor = "default", projection;
  DescriptorParams params;
  const CLI::Option* pairs = nullptr;

  void addTo(CLI::App& app) {
    app.add_option("--descriptor", descriptor, "What views are described with; queries are described alike")
        ->capture_default_str()
        ->check(CLI::IsMember({"default", "paper"}));
    app.add_option("--projection", projection, "Of descriptor default: made by `voxid train`, instead of the one shipped")
        ->type_name("FILE");
    pairs = app.add_option("--pairs", params.pairs, "Of descriptor paper: lines drawn")
                ->capture_default_str()
                ->check(CLI::Range(1, 1000000));
  }

  Result<Profile> profile() const {
    if (descriptor == "paper") {
      if (!projection.empty()) return Status::badUse("--projection is for --descriptor default");
      return Profile{params, nullptr};
    }
    if (pairs->count() > 0) return Status::badUse("--pairs is for --descriptor paper; a projection says how many pairs it needs");
    const auto read = projection.empty() ? shippedProjection() : Projection::read(projection);
    if (!read.ok()) return read.status;
    return Profile{{}, read.value};
  }
};

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
  printSkipped(report.value.skipped);
  printEmpty(report.value);
  if (json) printDoneEvent(report.value);
  else printDone(report.value, options.out);
  return {};
}

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
  const auto choice = std::make_shared<DescriptorChoice>();
  choice->addTo(app);
  app.add_flag("--json", *json, "Events as JSON, one a line on standard output");
  return [options, json, choice] {
    auto profile = choice->profile();
    if (!profile.ok()) return profile.status;
    options->profile = std::move(profile.value);
    return run(*options, *json);
  };
}

}  // namespace voxid::cli
