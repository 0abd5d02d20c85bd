// SPDX-License-Identifier: BSD-3-Clause
#include "model_shelf.h"

#include <algorithm>
#include <filesystem>
#include <vector>

#include "mesh_file.h"
#include "voxid/library/model_surface.h"
#include "voxid/library/views.h"

namespace voxid::cli {
namespace {

namespace fs = std::filesystem;

Result<std::shared_ptr<const ShelvedModel>> readModel(const std::string& models, const std::string& name) {
  const Result<std::string> path = meshOf(models, name);
  if (!path.ok()) return path.status;
  const Result<Mesh> mesh = readMeshFile(path.value);
  if (!mesh.ok()) return mesh.status;
  ModelSurface surface = surfaceOf(mesh.value);
  const Symmetry symmetry = findSymmetry(surface);
  const Directions& directions = viewDirections();
  return std::shared_ptr<const ShelvedModel>(
      new ShelvedModel{{std::move(surface), {directions.data(), directions.size()}}, symmetry});
}

}  // namespace

Result<std::string> meshOf(const std::string& models, const std::string& name) {
  const fs::path wanted = fs::path(models) / name;
  std::vector<std::string> found;
  std::error_code error;
  for (fs::directory_iterator it(wanted.parent_path(), error), end; !error && it != end; it.increment(error)) {
    const bool named = it->path().stem() == wanted.filename();
    if (named && isMeshFile(it->path().filename().string())) found.push_back(it->path().string());
  }
  if (found.empty())
    return Status::cannotDo(wanted.string() +
                            ": no mesh of this name; --models expects the folder that the index was made from");
  return *std::min_element(found.begin(), found.end());
}

std::string fullNameOf(const Index& index, std::uint32_t model) {
  return std::string(index.categoryName(index.models()[model].category)) + "/" + std::string(index.modelName(model));
}

Result<std::shared_ptr<const ShelvedModel>> ModelShelf::find(const std::string& name) {
  const auto known = read_.find(name);
  if (known != read_.end()) return known->second;
  return read_.emplace(name, readModel(models_, name)).first->second;
}

}  // namespace voxid::cli
