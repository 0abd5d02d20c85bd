// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/library/builder.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>

#include "calibrate.h"
#include "model_folder.h"
#include "model_views.h"
#include "parts_folder.h"
#include "render_models.h"
#include "shard.h"
#include "voxid/core/index.h"
#include "voxid/library/confidence_learner.h"
#include "voxid/library/index_writer.h"
#include "voxid/library/shrink_codes.h"
#include "voxid/library/views.h"

namespace voxid {
namespace {

namespace fs = std::filesystem;

Status check(const BuildOptions& options) {
  const auto range = [](const char* what, int found, int most) {
    return Status::badUse(std::string(what) + " is " + std::to_string(found) + ", expected 1 to " + std::to_string(most));
  };
  if (options.jobs < 1 || options.jobs > 1024) return range("the number of jobs", options.jobs, 1024);
  if (options.views_every < 1 || options.views_every > kDirections) return range("views-every", options.views_every, kDirections);
  if (options.out.empty() || fs::path(options.out).filename().empty()) return Status::badUse("'" + options.out + "' names no index file");
  return {};
}

class Builder {
 public:
  Builder(const BuildOptions& options, BuildListener& listener) : options_(options), listener_(listener) {}

  Result<BuildReport> build() {
    Status status = check(options_);
    if (!status.ok()) return status;
    Result<ModelFolder> folder = listModels(options_.models);
    if (!folder.ok()) return folder.status;
    folder_ = std::move(folder.value);
    if (folder_.models.empty()) return nothing("no mesh in " + options_.models + "; expected <category>/<model>.ply, .obj, ...; see doc/build.md");
    status = parts_.open(options_.out, options_.resume);
    if (status.ok()) status = renderModels(work(), died_);
    if (status.ok()) status = merge();
    if (status.ok()) status = finish();
    if (!status.ok() && status.kind != Status::Kind::NothingFound) return status;
    parts_.remove();
    if (!status.ok()) return status;
    return std::move(report_);
  }

  Result<BuildReport> buildPart(const BuildPart& part) {
    Status status = check(options_);
    if (!status.ok()) return status;
    if (part.parts < 1 || part.part < 0 || part.part >= part.parts) return Status::badUse("there is no such part; expected 0 to parts - 1");
    Result<ModelFolder> folder = listModels(options_.models);
    if (!folder.ok()) return folder.status;
    for (std::size_t i = static_cast<std::size_t>(part.part); i < folder.value.models.size(); i += static_cast<std::size_t>(part.parts)) {
      folder_.models.push_back(std::move(folder.value.models[i]));
    }
    status = parts_.join(options_.out);
    if (status.ok() && !folder_.models.empty()) status = renderModels(work(), died_);
    if (status.ok()) countShards();
    if (!status.ok()) return status;
    return std::move(report_);
  }

 private:
  void countShards() {
    for (std::size_t i = 0; i < folder_.models.size(); ++i) {
      const ModelFile& model = folder_.models[i];
      const auto died = died_.find(static_cast<int>(i));
      const Result<ModelViews> shard = readShard(shardOf(model), originOf(model));
      if (died != died_.end() || shard.value.views.empty()) {
        report_.skipped.push_back({model.file, died != died_.end() ? died->second : shard.value.refusal});
        continue;
      }
      ++report_.models;
      report_.views += static_cast<int>(shard.value.views.size());
    }
  }

  Status nothing(const std::string& why) { return Status::nothingFound(why); }

  RenderWork work() const {
    RenderWork work{folder_, parts_.path(), listener_};
    work.jobs = options_.jobs;
    work.choice.views_every = options_.views_every;
    work.parameters = parametersOf(options_.profile);
    work.mesh_limits = options_.mesh_limits;
    work.makeEncode = [this] { return encodeWith(options_.profile); };
    return work;
  }
  ShardOrigin originOf(const ModelFile& model) const { return voxid::originOf(model, parametersOf(options_.profile), options_.views_every); }
  std::string shardOf(const ModelFile& model) const { return shardPath(parts_.path(), model); }

  Status merge() {
    content_.profile = options_.profile;
    content_.directions.assign(viewDirections().begin(), viewDirections().end());
    for (std::size_t i = 0; i < folder_.models.size(); ++i) {
      const auto died = died_.find(static_cast<int>(i));
      if (died == died_.end()) mergeOne(folder_.models[i]);
      else report_.skipped.push_back({folder_.models[i].file, died->second});
    }
    std::set<std::string> taught;
    for (const ModelRecord& model : content_.models) taught.insert(model.category);
    for (const std::string& category : folder_.categories) {
      if (taught.count(category) == 0) report_.empty_categories.push_back(category);
    }
    report_.categories = static_cast<int>(taught.size());
    report_.models = static_cast<int>(content_.models.size());
    if (content_.models.empty()) return nothing("no model of " + options_.models + " can be used; the first: " + report_.skipped[0].model + ": " + report_.skipped[0].reason);
    return {};
  }

  void mergeOne(const ModelFile& file) {
    Result<ModelViews> shard = readShard(shardOf(file), originOf(file));
    if (!shard.ok()) shard.value.refusal = shard.status.sentence;
    if (!shard.ok() || shard.value.views.empty()) return report_.skipped.push_back({file.file, shard.value.refusal});
    ModelRecord model;
    model.category = file.category;
    model.name = file.name;
    model.licence = file.licence;
    model.origin = file.origin;
    model.synset = file.synset;
    model.sense = file.sense;
    model.views = std::move(shard.value.views);
    if (options_.profile.projection) shrinkToMean(codesIn(model.views), options_.profile.codeBytes());
    report_.views += static_cast<int>(model.views.size());
    content_.models.push_back(std::move(model));
    calibration_codes_[{file.category, file.name}] = std::move(shard.value.calibration);
  }

  Status finish() {
    const std::string draft = parts_.path() + "/draft.vxi";
    Status status = writeIndex(content_, draft);
    if (!status.ok()) return status;
    const auto index = Index::open(draft);
    if (!index.ok()) return index.status;
    content_.calibration = calibrate(index.value, queriesOf(*index.value));
    status = writeWithConfidence(content_, draft, options_.out);
    if (!status.ok()) return status;
    std::error_code ignored;
    report_.bytes = fs::file_size(options_.out, ignored);
    report_.calibration_samples = static_cast<int>(content_.calibration.samples);
    report_.confidence = content_.confidence;
    return {};
  }

  /// Numbered as in the index, which sorts models in its own way.
  std::vector<CalibrationQuery> queriesOf(const Index& index) const {
    std::vector<CalibrationQuery> queries;
    for (std::uint32_t i = 0; i < index.models().size; ++i) {
      const std::string category(index.categoryName(index.models()[i].category)), name(index.modelName(i));
      const auto found = calibration_codes_.find({category, name});
      if (found != calibration_codes_.end()) queries.push_back({i, found->second});
    }
    return queries;
  }

  const BuildOptions& options_;
  BuildListener& listener_;
  ModelFolder folder_;
  PartsFolder parts_;
  std::map<int, std::string> died_;
  IndexContent content_;
  std::map<std::pair<std::string, std::string>, std::vector<std::uint8_t>> calibration_codes_;
  BuildReport report_;
};

}  // namespace

Result<BuildReport> buildIndex(const BuildOptions& options, BuildListener& listener) { return Builder(options, listener).build(); }

Result<BuildReport> buildPart(const BuildOptions& options, const BuildPart& part, BuildListener& listener) {
  return Builder(options, listener).buildPart(part);
}

}  // namespace voxid
