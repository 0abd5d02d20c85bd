// SPDX-License-Identifier: BSD-3-Clause
// voxid eval: how well an index names labelled objects.
#include <cstdio>
#include <iostream>
#include <memory>

#include "command.h"
#include "compare.h"
#include "compare_codes.h"
#include "draw_confusion.h"
#include "eval_memory.h"
#include "eval_poses.h"
#include "eval_queries.h"
#include "eval_retrieval.h"
#include "eval_scenes.h"
#include "eval_unknown.h"

namespace voxid::cli {
namespace {

struct Options {
  std::string index, queries, confusion, unseen, plot;
  CompareOptions compare;
  SceneOptions scenes;
  SearchChoice search;
  PoseOptions poses;
  int every = 1, jobs = 1;
  bool json = false, comparing = false, retrieval = false, unknown = false, memory = false, posing = false;
};

std::string intervalText(const Json& interval) {
  char text[32];
  std::snprintf(text, sizeof text, "(%.2f to %.2f)", interval[0].get<double>(), interval[1].get<double>());
  return text;
}

void printRow(const Json& row) {
  std::printf("%-11s %-6s %6.2f %17s %9.2f %6.2f %10.0f %11.1f", row["descriptor"].get<std::string>().c_str(),
              row["method"].get<std::string>().c_str(), row["top1"].get<double>(), intervalText(row["top1_95"]).c_str(),
              row["mean_category"].get<double>(), row["top5"].get<double>(), row["us_per_query"].get<double>(),
              row["bytes_per_view"].get<double>());
  if (row.contains("minus_vote")) {
    std::printf("   %+.2f %s against vote", row["minus_vote"].get<double>(),
                intervalText(row["minus_vote_95"]).c_str());
  }
  if (row.contains("minus_esf") && !row["minus_esf"].is_null()) {
    std::printf(" %+10.2f %17s", row["minus_esf"].get<double>(), intervalText(row["minus_esf_95"]).c_str());
  }
  std::printf("\n");
}

std::string percentText(const Json& share) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f %%", share.is_null() ? 0.0 : share.get<double>());
  return text;
}

void printLevels(const Json& levels) {
  std::printf(
      "by vote, as synsets: top-1 %s; a synset is told of %s, rightly of %s of them; of %s its category is wrong, and "
      "of %s of these the synset is right\n",
      percentText(levels["synset_top1"]).c_str(), percentText(levels["told"]).c_str(),
      percentText(levels["told_right"]).c_str(), percentText(levels["told_but_category_wrong"]).c_str(),
      percentText(levels["right_of_these"]).c_str());
}

void printTable(const Json& result) {
  std::printf("%s; accuracies in %%, top-1 with its 95 %% interval over the models",
              counted(result["queries"].get<std::size_t>(), "query", "queries").c_str());
  if (result.contains("every")) {
    std::printf("; %s, each %d. of the index", counted(result["views"].get<std::size_t>(), "view").c_str(),
                result["every"].get<int>());
  }
  std::printf("\n%-11s %-6s %6s %17s %9s %6s %10s %11s", "descriptor", "method", "top-1", "", "mean cat.", "top-5",
              "us/query", "bytes/view");
  std::printf(result.contains("every") ? " %10s\n" : "\n", "minus esf");
  for (const Json& row : result["rows"]) printRow(row);
  if (result.contains("levels") && !result["levels"].is_null()) printLevels(result["levels"]);
}

/// As a line of JSON if that is wanted, else as people read it.
void print(const Options& options, const Json& result, void (*table)(const Json&)) {
  if (options.json) {
    std::cout << lineOf(result);
  } else {
    table(result);
  }
}

Status print(const Options& options, const Result<Json>& result, void (*table)(const Json&)) {
  if (result.ok()) print(options, result.value, table);
  return result.status;
}

CompareOptions compareOptionsOf(const Options& options) {
  CompareOptions compare = options.compare;
  compare.every = options.every;
  compare.jobs = options.jobs;
  return compare;
}

Status compare(const Options& options, const std::shared_ptr<const Index>& index) {
  const auto queries = readQueries(options.queries, 1);
  if (!queries.ok()) return queries.status;
  const auto result =
      compareDescriptors(index, queries.value, cameraOfFolder(options.queries), compareOptionsOf(options));
  return print(options, result, printTable);
}

Status evaluate(const Options& options, const std::shared_ptr<const Index>& index) {
  const auto queries = readQueries(options.queries, options.every);
  if (!queries.ok()) return queries.status;
  QueryOptions how;
  how.search = options.search;
  how.evidence = options.scenes.evidence;
  how.models = options.compare.models;
  how.jobs = options.jobs;
  const auto evaluation = evaluateQueries(index, queries.value, cameraOfFolder(options.queries), how);
  if (!evaluation.ok()) return evaluation.status;
  print(options, evaluation.value.result, printTable);
  if (options.confusion.empty()) return {};
  return writeImage(options.confusion, drawConfusion(queries.value, evaluation.value.votes));
}

Status evaluateScores(const Options& options, const std::shared_ptr<const Index>& index) {
  const auto queries = readQueries(options.queries, options.every);
  if (!queries.ok()) return queries.status;
  UnknownOptions unknown;
  unknown.models = options.compare.models;
  unknown.plot = options.plot;
  unknown.jobs = options.jobs;
  const auto result = evaluateUnknown(index, queries.value, cameraOfFolder(options.queries), unknown);
  return print(options, result, printUnknown);
}

Status evaluateFrames(const Options& options, const std::shared_ptr<const Index>& index) {
  MemoryOptions memory;
  memory.models = options.unseen;
  memory.search = options.search;
  memory.jobs = options.jobs;
  const auto result = evaluateMemory(index, memory);
  return print(options, result, printMemory);
}

Status evaluateReal(const Options& options, const std::shared_ptr<const Index>& index) {
  SceneOptions scenes = options.scenes;
  scenes.models = options.compare.models;
  scenes.comparing = options.comparing;
  scenes.compare = compareOptionsOf(options);
  const auto result = evaluateScenes(index, scenes);
  return print(options, result, printScenes);
}

/// The index, if one is named, says how the descriptor is made.
Status retrieve(const Options& options) {
  RetrievalOptions retrieval;
  retrieval.models = options.compare.models;
  retrieval.unseen = options.unseen;
  retrieval.jobs = options.jobs;
  if (!options.index.empty()) {
    const auto index = Index::open(options.index);
    if (!index.ok()) return index.status;
    retrieval.params = paperParamsOf(*index.value);
  }
  const auto result = evaluateRetrieval(retrieval);
  return print(options, result, printRetrieval);
}

Status pose(const Options& options, const std::shared_ptr<const Index>& index) {
  PoseOptions poses = options.poses;
  poses.models = options.compare.models;
  poses.unseen = options.unseen;
  poses.jobs = options.jobs;
  poses.pcl_every = options.comparing ? options.every : 0;
  const auto result = evaluatePoses(index, options.search, poses);
  return print(options, result, printPoses);
}

Status checkPoses(const Options& options) {
  if (options.compare.models.empty() || options.unseen.empty()) {
    return Status::badUse(
        "--poses needs --models DIR, the folder that the index was made from, and --unseen DIR, other models");
  }
  return {};
}

Status checkRetrieval(const Options& options) {
  if (options.compare.models.empty() || options.unseen.empty()) {
    return Status::badUse("--retrieval needs --models DIR, what is searched, and --unseen DIR, what is asked for");
  }
  return {};
}

Status checkEvidence(const Options& options) {
  const EvidenceChoice& evidence = options.scenes.evidence;
  if (const Status fits = evidence.check(); !fits.ok()) return fits;
  if (evidence.names.empty()) return {};
  if (options.queries.empty() && options.scenes.folder.empty())
    return Status::badUse("--evidence is for --queries and --scenes");
  if (options.unknown) return Status::badUse("--unknown excludes --evidence");
  if (options.comparing && (evidence.align() || !options.queries.empty()))
    return Status::badUse("--compare takes --evidence size with --scenes only");
  return {};
}

Status check(const Options& options) {
  if (options.retrieval) return checkRetrieval(options);
  if (!options.unseen.empty() && !options.memory && !options.posing)
    return Status::badUse("--unseen is for --retrieval, --memory and --poses");
  if (Status status = checkEvidence(options); !status.ok()) return status;
  if (options.index.empty()) return Status::badUse("--index is required, except with --retrieval; see --help");
  if (options.memory && options.posing) return Status::badUse("--poses excludes --memory");
  if (options.memory) {
    return options.unseen.empty() ? Status::badUse("--memory needs --unseen DIR, models that the index does not hold")
                                  : Status();
  }
  if (options.posing) return checkPoses(options);
  if (options.queries.empty() == options.scenes.folder.empty()) {
    return Status::badUse("eval needs either --queries DIR or --scenes DIR");
  }
  if (options.unknown && options.queries.empty()) return Status::badUse("--unknown needs --queries DIR");
  if (options.comparing && options.compare.models.empty()) {
    return Status::badUse("--compare needs --models DIR, the folder that the index was made from");
  }
  return {};
}

Status run(const Options& options) {
  if (Status status = check(options); !status.ok()) return status;
  if (options.retrieval) return retrieve(options);
  const auto index = Index::open(options.index);
  if (!index.ok()) return index.status;
  if (const Status fits = options.search.check(*index.value); !fits.ok()) return fits;
  if (options.scenes.evidence.align()) {
    const Status known = checkSurfaces("--evidence align", *index.value, options.compare.models);
    if (!known.ok()) return known;
  }
  if (options.memory) return evaluateFrames(options, index.value);
  if (options.posing) return pose(options, index.value);
  if (!options.scenes.folder.empty()) return evaluateReal(options, index.value);
  if (options.unknown) return evaluateScores(options, index.value);
  return options.comparing ? compare(options, index.value) : evaluate(options, index.value);
}

// What is measured. Those that cannot go together exclude one another.
struct Modes {
  CLI::Option *queries, *scenes, *comparing, *retrieval, *unknown, *posing;
};

Modes addModes(CLI::App& app, Options& options) {
  Modes modes{};
  modes.queries = app.add_option("--queries", options.queries,
                                 "Depth images of one object each, with queries.csv (file,category,model)")
                      ->type_name("DIR");
  modes.scenes = app.add_option("--scenes", options.scenes.folder,
                                "Real scenes with labels and objects.json, instead of --queries")
                     ->type_name("DIR");
  modes.comparing =
      app.add_flag("--compare", options.comparing,
                   "Descriptors beside one another on the same views, PCL's ESF among them; with --poses: "
                   "PCL's SampleConsensusPrerejective and ICP on each N-th view of a member (--every)");
  modes.retrieval = app.add_flag("--retrieval", options.retrieval,
                                 "Whole models asked for among whole models, instead of views; needs no index")
                        ->excludes(modes.queries, modes.scenes, modes.comparing);
  modes.unknown =
      app.add_flag("--unknown", options.unknown,
                   "Whether scores say how likely an answer is right, and are low where its category is not there")
          ->excludes(modes.comparing, modes.retrieval, modes.scenes);
  CLI::Option* const memory =
      app.add_flag("--memory", options.memory,
                   "What several frames say more than one: models of --unseen on a circle of twelve frames")
          ->excludes(modes.queries, modes.scenes, modes.comparing, modes.retrieval, modes.unknown);
  modes.posing =
      app.add_flag("--poses", options.posing, "Poses and sizes of models, on views drawn anew whose pose is known")
          ->excludes(modes.queries, modes.scenes, modes.retrieval, modes.unknown, memory);
  return modes;
}

void addOfScenes(CLI::App& app, SceneOptions& scenes, CLI::Option* mode) {
  const auto addFile = [&](const char* name, std::string& file, const char* about) {
    app.add_option(name, file, about)->type_name("FILE")->needs(mode);
  };
  addFile("--categories", scenes.categories,
          "With --scenes: a file of categories, one a line, that alone may be answers in further rows");
  addFile("--aliases", scenes.aliases,
          "With --scenes: a JSON file of what their categories may be called (default: cfg/aliases.json)");
  addFile("--look-alikes", scenes.look_alikes,
          "With --scenes: a YAML file of shapes that nobody can tell apart (default: cfg/look_alikes.yaml)");
  scenes.evidence.addTo(app);
}

void addOfPoses(CLI::App& app, PoseOptions& poses, CLI::Option* mode) {
  app.add_option("--objects", poses.objects, "With --poses: so many views of members, and of unseen models")
      ->type_name("N")
      ->check(CLI::Range(1, 1000000))
      ->needs(mode);
  app.add_option("--seed", poses.seed, "With --poses: draws the models and their views")
      ->check(CLI::Range(std::uint64_t{0}, std::uint64_t{1} << 31))
      ->needs(mode);
}

void addModels(CLI::App& app, Options& options) {
  app.add_option("--models", options.compare.models,
                 "With --compare, --unknown, --poses, --evidence align: the folder that the index was made from; with "
                 "--retrieval: the models searched")
      ->type_name("DIR");
  app.add_option("--unseen", options.unseen,
                 "With --retrieval, --memory, --poses: the models asked for, <category>/<model>.<ext>")
      ->type_name("DIR");
}

void addWork(CLI::App& app, Options& options) {
  app.add_option("--every", options.every,
                 "Take each N-th query only; with --compare every query, and each N-th view of the index; with --poses "
                 "--compare: what PCL is asked for")
      ->type_name("N")
      ->check(CLI::Range(1, 1000000));
  app.add_option("--jobs", options.jobs,
                 "Threads or processes; more finish sooner, but a query's time is measured best with 1, the default")
      ->type_name("N")
      ->check(CLI::Range(1, 256));
  options.search.addTo(app);
}

}  // namespace

Run addEval(CLI::App& app) {
  const auto options = std::make_shared<Options>();
  app.add_option("--index", options->index, "The index (.vxi) to measure")->type_name("FILE");
  const Modes modes = addModes(app, *options);
  addModels(app, *options);
  addOfScenes(app, options->scenes, modes.scenes);
  addOfPoses(app, options->poses, modes.posing);
  addWork(app, *options);
  app.add_flag("--json", options->json, "One JSON object");
  app.add_option("--confusion", options->confusion, "Draw which category was taken for which (method vote)")
      ->type_name("PATH.png");
  app.add_option("--plot", options->plot, "With --unknown: draw the reliability diagram and the risk over the coverage")
      ->type_name("PATH.png")
      ->needs(modes.unknown);
  return [options] { return run(*options); };
}

}  // namespace voxid::cli
