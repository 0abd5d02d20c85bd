// SPDX-License-Identifier: BSD-3-Clause
#include "evidence.h"

#include <algorithm>

namespace voxid::cli {
namespace {

bool contains(const std::vector<std::string>& names, const char* name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace

void EvidenceChoice::addTo(CLI::App& app) {
  app.add_option("--evidence", names,
                 "What counts beside the codes, a comma list: size (metric extents), align (how well models fit)")
      ->type_name("LIST")
      ->delimiter(',')
      ->check(CLI::IsMember({"size", "align"}));
  const auto read = [this](const std::string& path) {
    auto sizes = ConfirmedSizes::read(path);
    if (!sizes.ok()) throw CLI::ValidationError("--confirmed-sizes", sizes.status.sentence);
    confirmed = std::move(sizes.value);
  };
  confirmed_sizes_ =
      app.add_option_function<std::string>("--confirmed-sizes", read,
                                           "With --evidence size: the file of the live chain's ~confirmed_sizes")
          ->type_name("FILE")
          ->check(CLI::ExistingFile);
}

bool EvidenceChoice::size() const { return contains(names, "size"); }
bool EvidenceChoice::align() const { return contains(names, "align"); }

Status EvidenceChoice::check() const {
  if (confirmed_sizes_ == nullptr || confirmed_sizes_->count() == 0 || size()) return {};
  return Status::badUse("--confirmed-sizes is for --evidence size");
}

Status checkSurfaces(const std::string& option, const Index& index, const std::string& models) {
  if (index.hasSurfaces() || !models.empty()) return {};
  return Status::badUse(option +
                        " needs --models DIR, the folder that the index was made from, or an index made with "
                        "`voxid build --keep-points`");
}

EvidenceRecogniser::EvidenceRecogniser(std::shared_ptr<const Index> index, const SearchChoice& search,
                                       const EvidenceChoice& evidence, const std::string& models)
    : evidence_(evidence), recogniser_(index, search) {
  if (evidence.size()) sizes_.emplace(*index, evidence.confirmed);
  if (!models.empty() || index->hasSurfaces()) naming_.emplace(index, models);
}

const Nearest* EvidenceRecogniser::nearest(const ObservedObject& object) {
  last_candidates_.clear();
  if (sizes_) sizes_->find(extent_.of_mm(object.depth, object.pixels), allowed_, &fitting_);
  last_nearest_ = recogniser_.nearest(object.depth, object.pixels, sizes_ ? fitting_ : allowed_);
  return last_nearest_;
}

Result<std::vector<SketchedModel>> EvidenceRecogniser::candidates(const Nearest& nearest) {
  return naming_->candidates(recogniser_.code(), nearest);
}

Result<Answer> EvidenceRecogniser::recognise(const ObservedObject& object, ClassifyMethod method,
                                             int min_score_permille) {
  const Nearest* const found = nearest(object);
  if (found == nullptr) return Answer{};
  if (!evidence_.align()) return classify(index(), *found, method, min_score_permille);
  auto models = candidates(*found);
  if (!models.ok()) return models.status;
  last_candidates_ = std::move(models.value);
  naming_->sketch(object, last_candidates_);
  return naming_->name(*found, last_candidates_, min_score_permille);
}

Result<ObjectPose> EvidenceRecogniser::pose(const ObservedObject& object, std::uint32_t category) {
  if (last_candidates_.empty() && last_nearest_ != nullptr) {
    auto models = candidates(*last_nearest_);
    if (!models.ok()) return models.status;
    last_candidates_ = std::move(models.value);
    naming_->sketch(object, last_candidates_);
  }
  const AlignedNaming::Posed posed = naming_->pose(last_candidates_, category);
  if (posed.model == nullptr) return ObjectPose{};
  return ObjectPose{fullNameOf(index(), posed.model->model), posed.model->shelved, posed.alignment};
}

}  // namespace voxid::cli
