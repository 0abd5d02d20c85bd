// SPDX-License-Identifier: BSD-3-Clause
// voxid info: what an index holds.
#include <cstdio>
#include <cstring>
#include <iostream>
#include <map>
#include <memory>

#include "bucket.h"
#include "command.h"
#include "evaluation.h"
#include "recogniser.h"
#include "voxid/library/confidence_learner.h"

namespace voxid::cli {
namespace {

struct Options {
  std::string file, bucket, plot, models;
  bool json = false, categories = false;
};

std::string profileOf(const format::Parameters& parameters) {
  return {parameters.profile, strnlen(parameters.profile, sizeof parameters.profile)};
}

Json licencesOf(const Index& index) {
  std::map<std::string, std::uint32_t> models;
  for (const format::Model& model : index.models()) ++models[std::string(index.string(model.licence))];
  Json licences = Json::array();
  for (const auto& [licence, count] : models) licences.push_back({{"licence", licence}, {"models", count}});
  return licences;
}

Json categoriesOf(const Index& index) {
  Json list = Json::array();
  for (const format::Category& category : index.categories()) {
    Json entry;
    entry["name"] = std::string(index.string(category.name));
    entry["synset"] = category.synset;
    entry["sense"] = std::string(index.senseOf(static_cast<std::uint32_t>(list.size())));
    entry["models"] = category.models;
    list.push_back(entry);
  }
  return list;
}

std::uint32_t surfaceCount(const Index& index) {
  std::uint32_t count = 0;
  for (std::uint32_t model = 0; model < index.models().size; ++model) count += index.surface(model).empty() ? 0 : 1;
  return count;
}

Json toJson(const Index& index, bool with_categories) {
  const format::Header& header = index.header();
  const format::Parameters& parameters = index.parameters();
  Json json;
  json["file"] = index.path();
  json["version"] = std::to_string(header.major) + "." + std::to_string(header.minor);
  json["descriptor"] = profileOf(parameters);
  json["revision"] = parameters.revision;
  json["pairs"] = parameters.pairs;
  json["seed"] = parameters.seed;
  json["categories"] = index.categories().size;
  json["models"] = index.models().size;
  json["views"] = index.viewCount();
  json["buckets"] = index.keys().size;
  json["bytes"] = index.bytes();
  json["bytes_per_view"] = bytesPerView(index);
  json["surfaces"] = surfaceCount(index);
  json["surface_bytes"] = index.surfaceBytes();
  json["code_bytes"] = parameters.code_bytes;
  json["calibration_samples"] = index.calibration().samples;
  const format::Confidence* const confidence = index.confidence();
  json["confidence_samples"] = confidence ? confidence->samples : 0;
  json["accuracy_to_expect"] = confidence ? Json(1.0 * confidence->right / confidence->samples) : Json(nullptr);
  json["licences"] = licencesOf(index);
  if (with_categories) json["category_list"] = categoriesOf(index);
  return json;
}

void printCategories(const Index& index) {
  for (const format::Category& category : index.categories()) {
    std::printf("  %-28s %s\n", std::string(index.string(category.name)).c_str(),
                counted(category.models, "model").c_str());
  }
}

void printExpectation(const Index& index) {
  const format::Confidence* const confidence = index.confidence();
  if (confidence == nullptr) {
    std::printf(
        "expect       not known: fewer than %u models in categories of three or more, or made before format 1.2\n",
        kConfidenceModels);
    return;
  }
  std::printf(
      "expect       %.1f %% of answers right for objects that are not in it, of categories that are (%u of its own "
      "views)\n",
      100.0 * confidence->right / confidence->samples, confidence->samples);
}

void printForPeople(const Index& index, bool with_categories) {
  const format::Parameters& parameters = index.parameters();
  std::printf("%s\n", index.path().c_str());
  std::printf("format       %u.%u\n", index.header().major, index.header().minor);
  std::printf("descriptor   %s, revision %u, %u pairs, seed %u\n", profileOf(parameters).c_str(), parameters.revision,
              parameters.pairs, parameters.seed);
  std::printf("categories   %zu\n", index.categories().size);
  if (with_categories) printCategories(index);
  std::printf("models       %zu\n", index.models().size);
  std::printf("views        %u in %zu buckets\n", index.viewCount(), index.keys().size);
  std::printf("bytes        %llu, %.1f a view\n", static_cast<unsigned long long>(index.bytes()), bytesPerView(index));
  if (index.hasSurfaces())
    std::printf("surfaces     %s, %s, not among those of a view\n", counted(surfaceCount(index), "model").c_str(),
                counted(index.surfaceBytes(), "byte").c_str());
  const std::uint32_t samples = index.calibration().samples;
  std::printf("calibration  %s\n",
              samples ? (std::to_string(samples) + " queries of its own models").c_str() : "built in");
  printExpectation(index);
  for (const Json& entry : licencesOf(index)) {
    const auto licence = entry["licence"].get<std::string>();
    std::printf("licence      %s: %s\n", licence.empty() ? "not stated" : licence.c_str(),
                counted(entry["models"].get<unsigned>(), "model").c_str());
  }
}

Status showBucket(const Options& options, const Index& index) {
  const auto bucket = findBucket(index, options.bucket);
  if (!bucket.ok()) return bucket.status;
  if (options.json) {
    std::cout << lineOf(toJson(index, bucket.value));
  } else {
    printBucket(index, bucket.value);
  }
  if (options.plot.empty()) return {};
  const auto picture = drawBucket(index, bucket.value, options.models);
  return picture.ok() ? writeImage(options.plot, picture.value) : picture.status;
}

Status run(const Options& options) {
  if (!options.plot.empty() && options.models.empty()) {
    return Status::badUse("--plot needs --models DIR, the folder that the index was made from");
  }
  const auto index = Index::open(options.file);
  if (!index.ok()) return index.status;
  if (!options.bucket.empty()) return showBucket(options, *index.value);
  if (options.json) {
    std::cout << lineOf(toJson(*index.value, options.categories));
  } else {
    printForPeople(*index.value, options.categories);
  }
  return {};
}

}  // namespace

Run addInfo(CLI::App& app) {
  const auto options = std::make_shared<Options>();
  app.add_option("file", options->file, "The index (.vxi)")->type_name("FILE")->required();
  app.add_flag("--json", options->json, "One JSON object");
  app.add_flag("--categories", options->categories, "List the categories with their numbers of models");
  CLI::Option* const bucket =
      app.add_option("--bucket", options->bucket, "List the views that share a hash key: 0x... or that of view:N")
          ->type_name("KEY");
  CLI::Option* const plot = app.add_option("--plot", options->plot, "Draw them")->type_name("PATH.png")->needs(bucket);
  app.add_option("--models", options->models, "With --plot: the folder that the index was made from")
      ->type_name("DIR")
      ->needs(plot);
  return [options] { return run(*options); };
}

}  // namespace voxid::cli
