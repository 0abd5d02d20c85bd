// SPDX-License-Identifier: BSD-3-Clause
#include "whole_models.h"

#include <algorithm>
#include <cstring>

#include "../library/model_folder.h"
#include "../library/worker_pool.h"
#include "esf.h"
#include "float_shapes.h"
#include "voxid/library/mesh_reader.h"
#include "voxid/library/surface_points.h"

namespace voxid::cli {
namespace {

constexpr std::size_t kPaper = 0, kD2 = 1, kEsf = 2;
static_assert(kWholeDescriptors[kPaper].bins == kDescriptorBytes && kWholeDescriptors[kD2].bins == kDistanceBins &&
              kWholeDescriptors[kEsf].bins == kEsfBins);

constexpr std::size_t kReason = 512;  // room for a sentence

/// Describes models into tables that processes share.
class Worker {
 public:
  Worker(const DescriptorParams& params, const WholeModels& out) : describer_(params), out_(out) {}

  void describe(const std::vector<PointUm>& points, std::size_t model) {
    const Span<const PointUm> span{points.data(), points.size()};
    const Described described = describer_.describe(span);
    if (described.status == DescribeStatus::Ok) {
      const FloatShapes shapes = floatShapesOf(span, describer_.params());
      keep(described.bins.data(), kPaper, model);
      keep(shapes.data(), kD2, model);
    }
    if (esf_->accept(span)) keep(esf_->describe().data(), kEsf, model);
  }

 private:
  template <typename T>
  void keep(const T* bins, std::size_t descriptor, std::size_t model) {
    CodeTable& table = *out_.tables[descriptor];
    std::copy_n(bins, kWholeDescriptors[descriptor].bins, reinterpret_cast<float*>(table.code(model)));
    table.answered.data()[model] = 1;
  }

  Describer describer_;
  std::unique_ptr<Esf> esf_ = makeEsf();
  const WholeModels& out_;
};

/// Refuses what a build refuses.
Result<Mesh> meshOf(const ModelFile& model) {
  return model.clash.empty() ? readMesh(model.path) : Result<Mesh>(Status::cannotDo(model.clash));
}

Status describeInProcesses(const ModelFolder& folder, const DescriptorParams& params, int jobs, WholeModels& out) {
  const SharedBytes reasons(folder.models.size() * kReason);
  const auto reason = [&](int model) { return reinterpret_cast<char*>(reasons.data()) + model * kReason; };
  Worker worker(params, out);  // each process has its copy
  PoolWork work;
  work.items = static_cast<int>(folder.models.size());
  work.work = [&](int item) -> Result<int> {
    const auto model = static_cast<std::size_t>(item);
    const auto mesh = meshOf(folder.models[model]);
    if (mesh.ok()) {
      worker.describe(surfacePoints(mesh.value), model);
    } else {
      std::strncpy(reason(item), mesh.status.sentence.c_str(), kReason - 1);
    }
    return 0;
  };
  work.onDone = [&](int item, int) { out.reasons[static_cast<std::size_t>(item)] = reason(item); };
  work.onDied = [&](int item, const std::string& how) {
    out.reasons[static_cast<std::size_t>(item)] = "its worker died (" + how + ")";
  };
  work.onTick = [] {};
  return runInProcesses(jobs, work);
}

}  // namespace

Result<WholeModels> describeWholeModels(const std::string& path, const DescriptorParams& params, int jobs) {
  const auto folder = listModels(path);
  if (!folder.ok()) return folder.status;
  WholeModels out;
  for (const ModelFile& model : folder.value.models) {
    out.categories.push_back(model.category);
    out.names.push_back(model.file);
  }
  if (out.names.empty()) return Status::nothingFound(path + ": no mesh in it; expected <category>/<model>.<ext>");
  out.reasons.resize(out.names.size());
  for (const WholeDescriptor& descriptor : kWholeDescriptors) {
    const std::size_t bytes = static_cast<std::size_t>(descriptor.bins) * sizeof(float);
    out.tables.push_back(std::make_unique<CodeTable>(out.names.size(), bytes));
  }
  const Status status = describeInProcesses(folder.value, params, jobs, out);
  if (!status.ok()) return status;
  if (std::count(out.reasons.begin(), out.reasons.end(), "") == 0)
    return Status::nothingFound(path + ": none of its " + std::to_string(out.names.size()) + " meshes can be read");
  return out;
}

}  // namespace voxid::cli
