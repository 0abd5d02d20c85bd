// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/library/model_aligner.h"

#include <algorithm>
#include <cmath>

namespace voxid {
namespace {

void addModel(const Index& index, const Neighbour& neighbour, std::vector<RankedModel>& models) {
  const std::uint32_t model = index.modelOf(neighbour.view);
  if (model >= index.models().size) return;  // a damaged file; `verify` says where
  const bool known = std::any_of(models.begin(), models.end(), [&](const RankedModel& m) { return m.model == model; });
  if (!known) models.push_back({model, neighbour.view, static_cast<float>(neighbour.distance), {}});
}

/// Costs hold code distances, of either profile; a projection's are squared.
float ratioOf(const Index& index, float distance, float nearest) {
  const float ratio = std::max(distance, 1.0f) / std::max(nearest, 1.0f);
  return index.projection() ? std::sqrt(ratio) : ratio;
}

}  // namespace

std::vector<RankedModel> modelsOf(const Index& index, const Nearest& nearest, std::size_t most) {
  std::vector<RankedModel> models;
  for (const Neighbour& view : nearest.views) addModel(index, view, models);
  for (const Neighbour& view : nearest.categories) {
    if (models.size() < most) addModel(index, view, models);
  }
  if (models.size() > most) models.resize(most);
  return models;
}

Result<std::vector<RankedModel>> ModelAligner::rank(const ObservedObject& object, const Nearest& nearest) {
  const std::vector<RankedModel> found = modelsOf(*index_, nearest, kModels);
  std::vector<std::shared_ptr<const ShelvedModel>> shelved;
  std::vector<ModelCandidate> candidates;
  std::vector<RankedModel> readable;
  Status unread;
  for (const RankedModel& model : found) {
    auto read = shelf_.find(model.model);
    if (!read.ok()) {
      if (unread.ok()) unread = read.status;
      continue;
    }
    candidates.push_back({&read.value->model, ratioOf(*index_, model.cost, found.front().cost)});
    readable.push_back(model);
    shelved.push_back(std::move(read.value));
  }
  if (candidates.empty() && !unread.ok()) return unread;
  aligner_.observe(object);
  std::vector<RankedModel> ranked;
  for (const ChosenModel& chosen : chooseByAlignment(aligner_, {candidates.data(), candidates.size()})) {
    RankedModel model = readable[chosen.candidate];
    model.cost = chosen.cost;
    model.alignment = chosen.alignment;
    ranked.push_back(model);
  }
  return ranked;
}

}  // namespace voxid
