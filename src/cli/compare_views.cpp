// SPDX-License-Identifier: BSD-3-Clause
#include "compare_views.h"

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>

#include "voxid/library/mesh_reader.h"
#include "voxid/library/model_shelf.h"
#include "voxid/library/model_view.h"

namespace voxid::cli {
namespace {

/// Chosen views of one model: rows first to last - 1.
struct ModelRows {
  std::uint32_t model;
  std::size_t first, last;
};

std::vector<ModelRows> rowsByModel(const Index& index, const std::vector<std::uint32_t>& views) {
  std::vector<ModelRows> models;
  for (std::size_t row = 0; row < views.size(); ++row) {
    const std::uint32_t model = index.modelOf(views[row]);
    if (models.empty() || models.back().model != model) models.push_back({model, row, row});
    models.back().last = row + 1;
  }
  return models;
}

/// Describes models in one process.
class Worker {
 public:
  Worker(const Index& index, const std::string& models, const ComparedViews& out)
      : index_(index), models_(models), out_(out), codes_(comparedCodes(index)) {}

  Status describe(const ModelRows& rows) {
    const std::string name = fullNameOf(index_, rows.model);
    const Result<std::string> path = meshOf(models_, name);
    if (!path.ok()) return path.status;
    const Result<Mesh> mesh = readMesh(path.value);
    if (!mesh.ok()) return mesh.status;
    RayScene scene;
    scene.add(mesh.value, unitPlacement(mesh.value));
    scene.commit();
    for (std::size_t row = rows.first; row < rows.last; ++row) {
      const int direction = index_.view(out_.views[row]).direction;
      const ModelView view = drawModelView(scene, name, direction);
      if (!isInIndex(view, out_.views[row])) return foreign(name, direction);
      describeRow(view, row);
    }
    return {};
  }

 private:
  // By its extents.
  bool isInIndex(const ModelView& view, std::uint32_t number) const {
    const auto extents = extentsOf(view);
    const format::View kept = index_.view(number);
    for (std::size_t i = 0; i < extents.size(); ++i) {
      if (extents[i] >> 8 != kept.extents[i] >> 8) return false;
    }
    return true;
  }

  Status foreign(const std::string& name, int direction) const {
    return Status::cannotDo(models_ + ": view " + std::to_string(direction) + " of " + name +
                            " looks different in the index; --models expects the folder that the index was made from, "
                            "and an index made by this version");
  }

  void describeRow(const ModelView& view, std::size_t row) {
    for (std::size_t i = 0; i < codes_.size(); ++i) {
      const CodeTable& table = *out_.tables[i];
      table.answered.data()[row] =
          codes_[i]->describe(view.image.view(), {view.pixels.data(), view.pixels.size()}, table.code(row));
    }
  }

  const Index& index_;
  const std::string& models_;
  const ComparedViews& out_;
  std::vector<std::unique_ptr<ViewCode>> codes_;
};

/// Room for a sentence that a process leaves behind.
constexpr std::size_t kSentence = 1024;

void workInChild(const Index& index, const std::string& models, const ComparedViews& out,
                 const std::vector<ModelRows>& rows, std::size_t first, std::size_t step, char* sentence) {
  Worker worker(index, models, out);
  for (std::size_t i = first; i < rows.size(); i += step) {
    const Status status = worker.describe(rows[i]);
    if (status.ok()) continue;
    std::strncpy(sentence, status.sentence.c_str(), kSentence - 1);
    ::_exit(static_cast<int>(status.kind));
  }
  ::_exit(0);
}

Status statusOf(int wait_status, const char* sentence) {
  if (WIFEXITED(wait_status) && WEXITSTATUS(wait_status) == 0) return {};
  if (WIFEXITED(wait_status) && *sentence != '\0') {
    return {static_cast<Status::Kind>(WEXITSTATUS(wait_status)), sentence};
  }
  return Status::cannotDo("a process that describes views died");
}

Status describeInProcesses(const Index& index, const std::string& models, const ComparedViews& out, int jobs) {
  const std::vector<ModelRows> rows = rowsByModel(index, out.views);
  const auto processes = static_cast<std::size_t>(jobs);
  const SharedBytes sentences(processes * kSentence);
  const auto sentence = [&](std::size_t i) { return reinterpret_cast<char*>(sentences.data() + i * kSentence); };
  std::vector<pid_t> children;
  for (std::size_t i = 0; i < processes; ++i) {
    const pid_t child = ::fork();
    if (child == 0) workInChild(index, models, out, rows, i, processes, sentence(i));
    children.push_back(child);
  }
  Status first_failure;
  for (std::size_t i = 0; i < processes; ++i) {
    int ended = 0;
    const bool waited = children[i] > 0 && ::waitpid(children[i], &ended, 0) == children[i];
    Status status = waited ? statusOf(ended, sentence(i)) : Status::cannotDo("no further process can be started");
    if (first_failure.ok()) first_failure = std::move(status);
  }
  return first_failure;
}

}  // namespace

Result<ComparedViews> describeViews(const Index& index, const std::string& models, int every, int jobs) {
  ComparedViews out;
  for (std::uint32_t view = 0; view < index.viewCount(); ++view) {
    if (index.view(view).direction % every == 0) out.views.push_back(view);
  }
  if (out.views.empty())
    return Status::nothingFound(index.path() + ": no view whose direction is a multiple of " + std::to_string(every));
  for (const auto& code : comparedCodes(index))
    out.tables.push_back(std::make_unique<CodeTable>(out.views.size(), code->bytes));
  const Status status = describeInProcesses(index, models, out, jobs);
  if (!status.ok()) return status;
  return out;
}

}  // namespace voxid::cli
