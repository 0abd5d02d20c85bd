// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/library/model_shelf.h"

#include <algorithm>
#include <filesystem>
#include <vector>

#include "voxid/library/mesh_reader.h"
#include "voxid/library/model_surface.h"
#include "voxid/library/views.h"

namespace voxid {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kBytesOfABook = 256;                     // its name, and a refusal's sentence
constexpr std::size_t kBytesOfLooks = std::size_t{100} << 10;  // see AlignableModel

std::size_t bytesOf(const ShelvedModel& model) {
  const ModelSurface& surface = model.model.surface();
  return kBytesOfLooks + surface.vertices.size() * sizeof(surface.vertices[0]) +
         surface.triangles.size() * sizeof(surface.triangles[0]);
}

}  // namespace

ShelvedModel::ShelvedModel(ModelSurface surface, std::optional<Symmetry> kept)
    : model(std::move(surface), {viewDirections().data(), viewDirections().size()}), symmetry_(kept) {}

const Symmetry& ShelvedModel::symmetry() const {
  std::call_once(looked_, [this] {
    if (!symmetry_) symmetry_ = findSymmetry(model.surface());
  });
  return *symmetry_;
}

Result<std::string> meshOf(const std::string& models, const std::string& name) {
  if (models.empty())
    return Status::cannotDo(
        name +
        ": no surface is known: the index keeps none (`voxid build --keep-points`), and no folder of models is given");
  const fs::path wanted = fs::path(models) / name;
  std::vector<std::string> found;
  std::error_code error;
  for (fs::directory_iterator it(wanted.parent_path(), error), end; !error && it != end; it.increment(error)) {
    const bool named = it->path().stem() == wanted.filename();
    if (named && isMeshFile(it->path().filename().string())) found.push_back(it->path().string());
  }
  if (found.empty())
    return Status::cannotDo(wanted.string() +
                            ": no mesh of this name; expected the folder of models that the index was made from");
  return *std::min_element(found.begin(), found.end());
}

std::string fullNameOf(const Index& index, std::uint32_t model) {
  return std::string(index.categoryName(index.models()[model].category)) + "/" + std::string(index.modelName(model));
}

Result<std::shared_ptr<const ShelvedModel>> ModelShelf::read(std::uint32_t model) const {
  const Span<const std::uint8_t> kept = index_->surface(model);
  if (!kept.empty()) {
    const auto surface = KeptSurface::of(kept);
    if (surface)
      return std::shared_ptr<const ShelvedModel>(
          std::make_shared<ShelvedModel>(surfaceOf(*surface), symmetryOf(*surface)));
    return Status::damaged("the index " + index_->path() + " is damaged: the surface of " + fullNameOf(*index_, model) +
                           " is not whole; `voxid verify` tells more");
  }
  const Result<std::string> path = meshOf(models_, fullNameOf(*index_, model));
  if (!path.ok()) return path.status;
  const Result<Mesh> mesh = readMeshFile(path.value);
  if (!mesh.ok()) return mesh.status;
  return std::shared_ptr<const ShelvedModel>(std::make_shared<ShelvedModel>(surfaceOf(mesh.value)));
}

Result<std::shared_ptr<const ShelvedModel>> ModelShelf::find(std::uint32_t number) {
  auto book = books_.find(number);
  if (book == books_.end()) {
    auto model = read(number);
    const std::size_t bytes = kBytesOfABook + (model.ok() ? bytesOf(*model.value) : 0);
    book = books_.emplace(number, Book{std::move(model), bytes, 0}).first;
    bytes_ += bytes;
  }
  book->second.last_asked = ++asked_;
  while (bytes_ > most_bytes_ && books_.size() > 1) forgetOldest();
  return book->second.model;
}

void ModelShelf::forgetOldest() {
  const auto oldest = std::min_element(books_.begin(), books_.end(), [](const auto& a, const auto& b) {
    return a.second.last_asked < b.second.last_asked;
  });
  bytes_ -= oldest->second.bytes;
  books_.erase(oldest);
}

}  // namespace voxid
