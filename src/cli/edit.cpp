// SPDX-License-Identifier: BSD-3-Clause
// voxid add, remove, merge: changes of an index.
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "build_progress.h"
#include "command.h"
#include "voxid/core/index.h"
#include "voxid/library/index_editor.h"

namespace voxid::cli {
namespace {

/// One line about what the index holds now.
Status sayWhatItHolds(const std::string& path) {
  const auto index = Index::open(path);
  if (!index.ok()) return index.status;
  const Index& whole = *index.value;
  std::fprintf(stderr, "voxid: %s: %s, %llu bytes\n", path.c_str(),
               countedModels(whole.viewCount(), whole.models().size, whole.categories().size).c_str(),
               static_cast<unsigned long long>(whole.bytes()));
  return {};
}

Status add(const BuildOptions& options, Clash clash) {
  Result<BuildReport> report = Status::cannotDo("not added");
  {
    ProgressBar listener;
    report = addModels(options, clash, listener);
  }
  if (!report.ok()) return report.status;
  printSkipped(report.value.skipped);
  return sayWhatItHolds(options.out);
}

void addReplace(CLI::App& app, bool& replace) {
  app.add_flag("--replace", replace, "Where a model is there already, take the new one instead of refusing");
}

Clash clashOf(bool replace) { return replace ? Clash::Replace : Clash::Refuse; }

}  // namespace

Run addAdd(CLI::App& app) {
  struct Options {
    BuildOptions build;
    bool replace = false;
  };
  const auto options = std::make_shared<Options>();
  BuildOptions& build = options->build;
  build.jobs = processors();
  app.add_option("index", build.out, "The index (.vxi)")->type_name("INDEX")->required();
  app.add_option("--models", build.models, "Folder with one folder a category, which holds a mesh file a model")
      ->required();
  app.add_option("--jobs", build.jobs, "Worker processes")->capture_default_str()->check(CLI::Range(1, 1024));
  app.add_option("--views-every", build.views_every, "Take every n-th of the 80 directions")
      ->capture_default_str()
      ->check(CLI::Range(1, 80));
  addReplace(app, options->replace);
  return [options] { return add(options->build, clashOf(options->replace)); };
}

Run addRemove(CLI::App& app) {
  struct Options {
    std::string index;
    std::vector<std::string> names;
  };
  const auto options = std::make_shared<Options>();
  app.add_option("index", options->index, "The index (.vxi)")->type_name("INDEX")->required();
  app.add_option("names", options->names, "Categories (mug) or models (mug/blue_mug)")->type_name("NAMES")->required();
  return [options] {
    const Status status = removeModels(options->index, options->names);
    return status.ok() ? sayWhatItHolds(options->index) : status;
  };
}

Run addMerge(CLI::App& app) {
  struct Options {
    std::vector<std::string> indices;
    std::string out;
    bool replace = false;
  };
  const auto options = std::make_shared<Options>();
  app.add_option("indices", options->indices, "Indices of the same descriptor; with --replace later ones win")
      ->type_name("INDEX...")
      ->required()
      ->expected(2, 1000);
  app.add_option("-o,--out", options->out, "The index to write")->required();
  addReplace(app, options->replace);
  return [options] {
    const Status status = mergeIndices(options->indices, options->out, clashOf(options->replace));
    return status.ok() ? sayWhatItHolds(options->out) : status;
  };
}

}  // namespace voxid::cli
