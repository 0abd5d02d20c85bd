// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/library/builder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <map>
#include <set>

#include "calibrate.h"
#include "model_folder.h"
#include "model_views.h"
#include "shard.h"
#include "voxid/core/index.h"
#include "voxid/library/index_writer.h"
#include "voxid/library/views.h"
#include "worker_pool.h"

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

/// <out>.parts, where finished models wait; one build at a time.
class PartsFolder {
 public:
  ~PartsFolder() {
    if (lock_ >= 0) ::close(lock_);
  }

  Status open(const std::string& out, bool keep) {
    path_ = out + ".parts";
    std::error_code error;
    fs::create_directory(path_, error);
    if (error) return Status::cannotDo("cannot make " + path_ + ": " + error.message());
    lock_ = ::open((path_ + "/lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (lock_ < 0) return Status::cannotDo("cannot write in " + path_ + ": " + std::strerror(errno));
    if (::flock(lock_, LOCK_EX | LOCK_NB) != 0) return Status::cannotDo("another build of " + out + " is running; wait for it, or choose another --out");
    if (!keep) clear();
    return {};
  }

  void remove() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  const std::string& path() const { return path_; }

 private:
  void clear() {
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(path_, ignored)) {
      if (entry.path().filename() != "lock") fs::remove(entry.path(), ignored);
    }
  }

  std::string path_;
  int lock_ = -1;
};

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
    if (status.ok()) status = renderAll();
    if (status.ok()) status = merge();
    if (status.ok()) status = finish();
    if (!status.ok() && status.kind != Status::Kind::NothingFound) return status;
    parts_.remove();
    if (!status.ok()) return status;
    return std::move(report_);
  }

 private:
  Status nothing(const std::string& why) { return Status::nothingFound(why); }

  ShardOrigin originOf(const ModelFile& model) const { return voxid::originOf(model, options_.params, options_.views_every); }
  std::string shardOf(const ModelFile& model) const { return shardPath(parts_.path(), model); }

  Status renderAll() {
    int done = 0;
    std::uint64_t views = 0;
    PoolWork work;
    work.items = static_cast<int>(folder_.models.size());
    work.work = [this](int item) { return renderOne(folder_.models[item]); };
    work.onDone = [&](int item, int made) {
      ++done;
      views += static_cast<std::uint64_t>(made);
      if (made > 0) return listener_.onModel(folder_.models[item].file, made);
      listener_.onSkipped({folder_.models[item].file, readShard(shardOf(folder_.models[item]), originOf(folder_.models[item])).value.refusal});
    };
    work.onDied = [&](int item, const std::string& how) {
      ++done;
      died_[item] = "its worker died (" + how + ")";
      listener_.onSkipped({folder_.models[item].file, died_[item]});
    };
    work.onTick = [&] { listener_.onProgress(done, work.items, views); };
    return runInProcesses(options_.jobs, work);
  }

  /// In a worker: the model's shard, which may be there already; the number of views in it.
  Result<int> renderOne(const ModelFile& model) const {
    const ShardOrigin origin = originOf(model);
    const Result<ModelViews> kept = readShard(shardOf(model), origin);
    if (kept.ok() && !kept.value.views.empty()) return static_cast<int>(kept.value.views.size());
    const ModelViews made = viewsOf(model);
    const Status status = writeShard(shardOf(model), origin, made);
    if (!status.ok()) return status;
    return static_cast<int>(made.views.size());
  }

  ModelViews viewsOf(const ModelFile& model) const {
    static Describer describer(options_.params);  // one a worker
    ModelViews refused;
    refused.refusal = model.clash;
    if (!model.clash.empty()) return refused;
    const Result<Mesh> mesh = readMesh(model.path, options_.mesh_limits);
    if (mesh.ok()) return makeViews(mesh.value, model.category + "/" + model.name, options_.views_every, describer);
    refused.refusal = mesh.status.sentence;
    return refused;
  }

  Status merge() {
    content_.params = options_.params;
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
    model.views = std::move(shard.value.views);
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
    std::remove(draft.c_str());
    status = writeIndex(content_, options_.out);
    if (!status.ok()) return status;
    std::error_code ignored;
    report_.bytes = fs::file_size(options_.out, ignored);
    report_.calibration_samples = static_cast<int>(content_.calibration.samples);
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

}  // namespace voxid
