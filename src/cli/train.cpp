// SPDX-License-Identifier: BSD-3-Clause
// voxid train: models become a projection.
#include <memory>
#include <string>

#include "build_progress.h"
#include "command.h"
#include "voxid/library/text_file.h"
#include "voxid/library/trainer.h"

namespace voxid::cli {
namespace {

struct Options {
  TrainOptions train;
  std::string without;  ///< file with a category a line
};

Result<std::vector<std::string>> linesOf(const std::string& path) {
  std::ifstream file = openText(path);
  if (!file) return Status::cannotDo("cannot read " + path);
  std::vector<std::string> lines;
  for (std::string line; std::getline(file, line);) {
    line.resize(line.find_last_not_of(" \t\r") + 1);  // none: npos + 1 = 0
    if (!line.empty() && line[0] != '#') lines.push_back(line);
  }
  return lines;
}

Status run(Options options) {
  if (!options.without.empty()) {
    auto lines = linesOf(options.without);
    if (!lines.ok()) return lines.status;
    options.train.without = std::move(lines.value);
  }
  Result<TrainReport> report = Status::cannotDo("not learnt");
  {
    ProgressBar listener;
    report = trainProjection(options.train, listener);
  }
  if (!report.ok()) return report.status;
  printSkipped(report.value.skipped);
  std::fprintf(stderr, "voxid: %s: learnt from %s, %llu bytes; %zu skipped\n", options.train.out.c_str(),
               countedModels(report.value.views, report.value.models, report.value.categories).c_str(),
               static_cast<unsigned long long>(report.value.bytes), report.value.skipped.size());
  return {};
}

}  // namespace

Run addTrain(CLI::App& app) {
  const auto options = std::make_shared<Options>();
  TrainOptions& train = options->train;
  train.jobs = processors();
  app.add_option("--models", train.models, "Folder with one folder a category, which holds a mesh file a model")
      ->required();
  app.add_option("-o,--out", train.out, "The projection to write (.vxp)")->required();
  app.add_option("--jobs", train.jobs, "Worker processes")->capture_default_str()->check(CLI::Range(1, 1024));
  app.add_option("--views-every", train.views_every, "Learn from every n-th of the 80 directions")
      ->capture_default_str()
      ->check(CLI::Range(1, 80));
  app.add_option("--lists", train.lists, "Of the quick search")->capture_default_str()->check(CLI::Range(1, 65536));
  app.add_option("--pairs", train.params.pairs, "Pairs of points a view")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000000));
  app.add_option("--without", options->without, "Leave these categories out, one a line")
      ->type_name("FILE")
      ->check(CLI::ExistingFile);
  return [options] { return run(*options); };
}

}  // namespace voxid::cli
