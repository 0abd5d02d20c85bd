// SPDX-License-Identifier: BSD-3-Clause
// voxid build: models become an index.
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "build_progress.h"
#include "command.h"
#include "python.h"
#include "voxid/library/builder.h"

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
  void onModel(const std::string& model, int views) override {
    printEvent({{"event", "model"}, {"model", model}, {"views", views}});
  }
  void onSkipped(const SkippedModel& skipped) override {
    printEvent({{"event", "skipped"}, {"model", skipped.model}, {"reason", skipped.reason}});
  }
};

void printEmpty(const BuildReport& report) {
  for (const std::string& category : report.empty_categories) {
    std::fprintf(stderr, "voxid: category %s has no readable mesh and is left out\n", oneLine(category).c_str());
  }
}

void printDone(const BuildReport& report, const std::string& out) {
  std::fprintf(stderr, "voxid: %s: %s, %llu bytes; %zu skipped\n", out.c_str(),
               countedModels(report.views, report.models, report.categories).c_str(),
               static_cast<unsigned long long>(report.bytes), report.skipped.size());
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
  std::uint32_t pairs = DescriptorParams{}.pairs, code_bytes = kCodeBytes;
  const CLI::Option *pairs_given = nullptr, *bytes_given = nullptr;

  void addTo(CLI::App& app) {
    app.add_option("--descriptor", descriptor, "What views are described with; queries are described alike")
        ->capture_default_str()
        ->check(CLI::IsMember({"default", "paper"}));
    app.add_option("--projection", projection,
                   "Of descriptor default: made by `voxid train`, instead of the one shipped")
        ->type_name("FILE");
    bytes_given = app.add_option("--bytes", code_bytes, "Of descriptor default: of a view's code")
                      ->capture_default_str()
                      ->check(CLI::IsMember({kSmallCodeBytes, kCodeBytes}));
    pairs_given = app.add_option("--pairs", pairs, "Of descriptor paper: lines drawn")
                      ->capture_default_str()
                      ->check(CLI::Range(1u, kMaxPairs));
  }

  /// As given, for another process.
  void addTo(std::vector<std::string>& arguments) const {
    arguments.insert(arguments.end(), {"--descriptor", descriptor});
    if (!projection.empty()) arguments.insert(arguments.end(), {"--projection", projection});
    if (bytes_given->count() > 0) arguments.insert(arguments.end(), {"--bytes", std::to_string(code_bytes)});
    if (pairs_given->count() > 0) arguments.insert(arguments.end(), {"--pairs", std::to_string(pairs)});
  }

  Result<Profile> profile() const {
    return profileOf(descriptor, projection, pairs_given->count() > 0 ? pairs : 0,
                     bytes_given->count() > 0 ? code_bytes : 0);
  }
};

/// Where the work is done, besides this process.
struct Places {
  int workers = 0;  ///< processes of a local cluster; 0 = none
  std::string scheduler, part;

  bool elsewhere() const { return workers > 0 || !scheduler.empty(); }
};

/// K/N, K below N.
Result<BuildPart> partOf(const std::string& text) {
  BuildPart part;
  char end = 0;
  if (std::sscanf(text.c_str(), "%d/%d%c", &part.part, &part.parts, &end) == 2 && part.part >= 0 &&
      part.part < part.parts)
    return part;
  return Status::badUse("--part " + text + ": expected K/N, such as 0/4, K below N");
}

Status distribute(const BuildOptions& options, const DescriptorChoice& choice, const Places& places, bool json) {
  std::vector<std::string> arguments = {"--models",  options.models,  "--out",
                                        options.out, "--views-every", std::to_string(options.views_every)};
  choice.addTo(arguments);
  if (options.keep_surfaces) arguments.push_back("--keep-points");
  if (options.resume) arguments.push_back("--resume");
  if (json) arguments.push_back("--json");
  if (places.workers > 0) arguments.insert(arguments.end(), {"--workers", std::to_string(places.workers)});
  if (!places.scheduler.empty()) arguments.insert(arguments.end(), {"--scheduler", places.scheduler});
  return handOver("build", arguments);
}

Result<BuildReport> buildAllOr(const std::string& part, const BuildOptions& options, BuildListener& listener) {
  if (part.empty()) return buildIndex(options, listener);
  const Result<BuildPart> share = partOf(part);
  return share.ok() ? buildPart(options, share.value, listener) : share.status;
}

/// The bar has left the terminal when it returns.
Result<BuildReport> buildWithProgress(const std::string& part, const BuildOptions& options, bool json) {
  if (json) {
    JsonListener events;
    return buildAllOr(part, options, events);
  }
  ProgressBar bar;
  return buildAllOr(part, options, bar);
}

Status run(const BuildOptions& options, const std::string& part, bool json) {
  const Result<BuildReport> report = buildWithProgress(part, options, json);
  if (!report.ok()) return report.status;
  printSkipped(report.value.skipped);
  printEmpty(report.value);
  if (json)
    printDoneEvent(report.value);
  else
    printDone(report.value, options.out);
  return {};
}

}  // namespace

Run addBuild(CLI::App& app) {
  auto options = std::make_shared<BuildOptions>();
  auto json = std::make_shared<bool>(false);
  options->jobs = processors();
  app.add_option("--models", options->models, "Folder with one folder a category, which holds a mesh file a model")
      ->required();
  app.add_option("--out", options->out, "The index to write (.vxi); an old one stays until the new one is whole")
      ->required();
  app.add_option("--jobs", options->jobs, "Worker processes; the index is the same for any number")
      ->capture_default_str()
      ->check(CLI::Range(1, 1024));
  app.add_flag("--keep-points", options->keep_surfaces,
               "Keep each model's surface in the index, so that poses need no models");
  app.add_flag("--resume", options->resume, "Go on where an interrupted build of the same models and settings ended");
  app.add_option("--views-every", options->views_every, "Take every n-th of the 80 directions")
      ->capture_default_str()
      ->check(CLI::Range(1, 80));
  const auto choice = std::make_shared<DescriptorChoice>();
  choice->addTo(app);
  app.add_flag("--json", *json, "Events as JSON, one a line on standard output");
  const auto places = std::make_shared<Places>();
  CLI::Option* const workers =
      app.add_option("--workers", places->workers, "Spread the models over so many workers of Dask on this machine");
  workers->check(CLI::Range(1, 1024))->type_name("N");
  CLI::Option* const scheduler =
      app.add_option("--scheduler", places->scheduler, "Spread them over the workers of this Dask scheduler");
  scheduler->type_name("tcp://HOST:PORT")->excludes(workers);
  app.add_option("--part", places->part,
                 "Finish every N-th model from number K on, in OUT.parts, and end; --resume takes them")
      ->type_name("K/N")
      ->excludes(workers, scheduler);
  return [options, json, choice, places] {
    auto profile = choice->profile();
    if (!profile.ok()) return profile.status;
    if (places->elsewhere()) return distribute(*options, *choice, *places, *json);
    options->profile = std::move(profile.value);
    return run(*options, places->part, *json);
  };
}

}  // namespace voxid::cli
