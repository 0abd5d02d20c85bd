// SPDX-License-Identifier: BSD-3-Clause
#include "render_models.h"

#include "shard.h"
#include "worker_pool.h"

namespace voxid {
namespace {

ModelViews viewsOf(const RenderWork& work, const ModelFile& model) {
  static const EncodeView encode = work.makeEncode();  // one a worker
  ModelViews refused;
  refused.refusal = model.clash;
  if (!model.clash.empty()) return refused;
  const Result<Mesh> mesh = readMesh(model.path, work.mesh_limits);
  if (mesh.ok()) return makeViews(mesh.value, model.category + "/" + model.name, work.choice, encode);
  refused.refusal = mesh.status.sentence;
  return refused;
}

ShardOrigin originIn(const RenderWork& work, const ModelFile& model) {
  return originOf(model, work.parameters, work.choice);
}

/// In a worker: the model's shard, which may be there already; the number of views in it.
Result<int> renderOne(const RenderWork& work, const ModelFile& model) {
  const std::string path = shardPath(work.parts, model);
  const ShardOrigin origin = originIn(work, model);
  const Result<ModelViews> kept = readShard(path, origin);
  if (kept.ok() && !kept.value.views.empty()) return static_cast<int>(kept.value.views.size());
  const ModelViews made = viewsOf(work, model);
  const Status status = writeShard(path, origin, made);
  if (!status.ok()) return status;
  return static_cast<int>(made.views.size());
}

}  // namespace

Status renderModels(const RenderWork& work, std::map<int, std::string>& died) {
  const auto& models = work.folder.models;
  int done = 0;
  std::uint64_t views = 0;
  PoolWork pool;
  pool.items = static_cast<int>(models.size());
  pool.work = [&](int item) { return renderOne(work, models[static_cast<std::size_t>(item)]); };
  pool.onDone = [&](int item, int made) {
    const ModelFile& model = models[static_cast<std::size_t>(item)];
    ++done;
    views += static_cast<std::uint64_t>(made);
    if (made > 0) return work.listener.onModel(model.file, made);
    work.listener.onSkipped({model.file, readShard(shardPath(work.parts, model), originIn(work, model)).value.refusal});
  };
  pool.onDied = [&](int item, const std::string& how) {
    ++done;
    died[item] = "its worker died (" + how + ")";
    work.listener.onSkipped({models[static_cast<std::size_t>(item)].file, died[item]});
  };
  pool.onTick = [&] { work.listener.onProgress(done, pool.items, views); };
  return runInProcesses(work.jobs, pool);
}

}  // namespace voxid
