// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/library/builder.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <numeric>
#include <set>
#include <tuple>

#include "calibrate.h"
#include "model_folder.h"
#include "model_views.h"
#include "parts_folder.h"
#include "render_models.h"
#include "shard.h"
#include "voxid/core/index.h"
#include "voxid/library/confidence_learner.h"
#include "voxid/library/index_assembler.h"
#include "voxid/library/shipped_projection.h"
#include "voxid/library/views.h"

namespace voxid {
namespace {

namespace fs = std::filesystem;

Status check(const BuildOptions& options) {
  const auto range = [](const char* what, int found, int most) {
    return Status::badUse(std::string(what) + " is " + std::to_string(found) + ", expected 1 to " +
                          std::to_string(most));
  };
  if (options.jobs < 1 || options.jobs > 1024) return range("the number of jobs", options.jobs, 1024);
  if (options.views_every < 1 || options.views_every > kDirections)
    return range("views-every", options.views_every, kDirections);
  if (options.out.empty() || fs::path(options.out).filename().empty())
    return Status::badUse("'" + options.out + "' names no index file");
  return {};
}

class Builder {
 public:
  Builder(const BuildOptions& options, BuildListener& listener)
      : options_(options),
        listener_(listener),
        whole_(options.profile, {viewDirections().begin(), viewDirections().end()}, options.out) {}

  Result<BuildReport> build() {
    Status status = check(options_);
    if (!status.ok()) return status;
    Result<ModelFolder> folder = listModels(options_.models);
    if (!folder.ok()) return folder.status;
    folder_ = std::move(folder.value);
    if (folder_.models.empty())
      return Status::nothingFound("no mesh in " + options_.models +
                                  "; expected <category>/<model>.ply, .obj, ...; see doc/build.md");
    status = parts_.open(options_.out, options_.resume);
    if (status.ok()) status = renderModels(work(), refused_);
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
    if (part.parts < 1 || part.part < 0 || part.part >= part.parts)
      return Status::badUse("there is no such part; expected 0 to parts - 1");
    Result<ModelFolder> folder = listModels(options_.models);
    if (!folder.ok()) return folder.status;
    for (std::size_t i = static_cast<std::size_t>(part.part); i < folder.value.models.size();
         i += static_cast<std::size_t>(part.parts)) {
      folder_.models.push_back(std::move(folder.value.models[i]));
    }
    status = parts_.join(options_.out);
    if (status.ok() && !folder_.models.empty()) status = renderModels(work(), refused_);
    if (status.ok()) countShards();
    if (!status.ok()) return status;
    return std::move(report_);
  }

 private:
  void countShards() {
    for (std::size_t i = 0; i < folder_.models.size(); ++i) {
      const ModelFile& model = folder_.models[i];
      const auto died = refused_.find(static_cast<int>(i));
      const Result<ModelViews> shard = readShard(shardOf(model), originOf(model));
      if (died != refused_.end() || shard.value.views.empty()) {
        report_.skipped.push_back({model.file, died != refused_.end() ? died->second : shard.value.refusal});
        continue;
      }
      ++report_.models;
      report_.views += static_cast<int>(shard.value.views.size());
    }
  }

  RenderWork work() const {
    RenderWork work{folder_, parts_.path(), listener_};
    work.jobs = options_.jobs;
    work.choice = choice();
    work.parameters = parametersOf(options_.profile);
    work.mesh_limits = options_.mesh_limits;
    work.makeEncode = [this] { return encodeWith(options_.profile); };
    return work;
  }
  ViewChoice choice() const {
    ViewChoice choice;
    choice.views_every = options_.views_every;
    choice.keep_surface = options_.keep_surfaces;
    return choice;
  }
  ShardOrigin originOf(const ModelFile& model) const {
    return voxid::originOf(model, parametersOf(options_.profile), choice());
  }
  std::string shardOf(const ModelFile& model) const { return shardPath(parts_.path(), model); }

  // Reads one finished model after another.
  Status merge() {
    for (const std::size_t i : inOrderOfIndex()) {
      const Status status = refused_.count(static_cast<int>(i)) > 0 ? Status{} : mergeOne(i);
      if (!status.ok()) return status;
    }
    for (const auto& [number, why] : refused_)
      report_.skipped.push_back({folder_.models[static_cast<std::size_t>(number)].file, why});
    for (const std::string& category : folder_.categories) {
      if (taught_.count(category) == 0) report_.empty_categories.push_back(category);
    }
    report_.categories = static_cast<int>(taught_.size());
    report_.models = static_cast<int>(whole_.models());
    if (report_.models == 0)
      return Status::nothingFound("no model of " + options_.models + " can be used; the first: " +
                                  report_.skipped[0].model + ": " + report_.skipped[0].reason);
    return {};
  }

  /// Numbers of models by category and name; the folder's order is that of file names.
  std::vector<std::size_t> inOrderOfIndex() const {
    std::vector<std::size_t> order(folder_.models.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [this](std::size_t a, std::size_t b) {
      const ModelFile &first = folder_.models[a], &second = folder_.models[b];
      return std::tie(first.category, first.name, a) < std::tie(second.category, second.name, b);
    });
    return order;
  }

  Status mergeOne(std::size_t number) {
    const ModelFile& file = folder_.models[number];
    Result<ModelViews> shard = readShard(shardOf(file), originOf(file));
    if (!shard.ok()) shard.value.refusal = shard.status.sentence;
    if (!shard.ok() || shard.value.views.empty()) {
      refused_[static_cast<int>(number)] = shard.value.refusal;
      return {};
    }
    ModelRecord model{file.category, file.name,      file.licence,
                      file.origin,   file.synset,    std::move(shard.value.views),
                      file.sense,    file.hypernyms, std::move(shard.value.surface)};
    report_.views += static_cast<int>(model.views.size());
    taught_.insert(file.category);
    calibration_queries_.push_back({whole_.models(), std::move(shard.value.calibration)});
    return whole_.add(model);
  }

  Status finish() {
    const auto learn = [this](const std::shared_ptr<const Index>& index) {
      return calibrate(index, calibration_queries_);
    };
    const auto learnt = writeWithConfidence(whole_, learn, parts_.path() + "/draft.vxi", options_.out);
    if (!learnt.ok()) return learnt.status;
    std::error_code ignored;
    report_.bytes = fs::file_size(options_.out, ignored);
    report_.calibration_samples = static_cast<int>(learnt.value.calibration.samples);
    report_.confidence = learnt.value.confidence;
    return {};
  }

  const BuildOptions& options_;
  BuildListener& listener_;
  ModelFolder folder_;
  PartsFolder parts_;
  std::map<int, std::string> refused_;  // by number, why
  IndexAssembler whole_;
  std::set<std::string> taught_;
  std::vector<CalibrationQuery> calibration_queries_;
  BuildReport report_;
};

}  // namespace

Result<Profile> profileOf(const std::string& descriptor, const std::string& projection, std::uint32_t pairs,
                          std::uint32_t code_bytes) {
  if (descriptor != "default" && descriptor != "paper")
    return Status::badUse("descriptor '" + descriptor + "': expected default or paper");
  if (pairs > kMaxPairs)
    return Status::badUse("--pairs is " + std::to_string(pairs) + ", expected 1 to " + std::to_string(kMaxPairs));
  if (code_bytes != 0 && code_bytes != kSmallCodeBytes && code_bytes != kCodeBytes)
    return Status::badUse("--bytes is " + std::to_string(code_bytes) + ", expected 32 or 48");
  if (descriptor == "paper") {
    if (!projection.empty()) return Status::badUse("--projection is for descriptor default");
    if (code_bytes != 0) return Status::badUse("--bytes is for descriptor default");
    Profile paper;
    if (pairs > 0) paper.params.pairs = pairs;
    return paper;
  }
  if (pairs > 0) return Status::badUse("--pairs is for descriptor paper; a projection says how many it needs");
  const auto read = projection.empty() ? shippedProjection() : Projection::read(projection);
  if (!read.ok()) return read.status;
  return Profile{{}, read.value, code_bytes == kSmallCodeBytes};
}

Result<BuildReport> buildIndex(const BuildOptions& options, BuildListener& listener) {
  return Builder(options, listener).build();
}

Result<BuildReport> buildPart(const BuildOptions& options, const BuildPart& part, BuildListener& listener) {
  return Builder(options, listener).buildPart(part);
}

}  // namespace voxid
