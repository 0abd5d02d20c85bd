// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/library/aligned_naming.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "voxid/core/refine.h"

namespace voxid {
namespace {

constexpr int kStarts = 5;  // views and rolls sketched of each model
constexpr std::size_t kPosedModels = 2, kPosedSketches = 2;

/// A damaged file may lead nowhere; `verify` says where.
bool isCategory(const Index& index, std::uint32_t category) { return category < index.categories().size; }

std::uint32_t categoryOfModel(const Index& index, std::uint32_t model) {
  return model < index.models().size ? index.models()[model].category : Search::kNone;
}

/// From a query's code to that of a view of a model of the category.
std::uint32_t distanceTo(const Index& index, const std::uint8_t* query, const std::uint8_t* code,
                         std::uint32_t category) {
  if (!index.projection()) return codeDistance(index.profile(), query, code);
  return movedDistance(query, code, index.mean(category), index.parameters().code_bytes);
}

Neighbour nearestViewOf(const Index& index, const std::uint8_t* code, const format::Model& model) {
  Neighbour nearest{Search::kNone, Search::kNone};
  const std::uint64_t end = std::min(std::uint64_t{model.first_view} + model.views, std::uint64_t{index.viewCount()});
  for (std::uint32_t view = model.first_view; view < end; ++view)
    nearest = std::min(nearest, Neighbour{view, distanceTo(index, code, index.code(view), model.category)});
  return nearest;
}

/// The nearest models of a category, nearest first.
std::vector<SketchedModel> nearestModels(const Index& index, const std::uint8_t* code, std::uint32_t category) {
  std::vector<SketchedModel> models;
  const format::Category& of = index.categories()[category];
  for (std::uint32_t i = of.first_model; i < of.first_model + of.models && i < index.models().size; ++i) {
    if (index.models()[i].category != category) continue;
    const Neighbour view = nearestViewOf(index, code, index.models()[i]);
    if (view.view != Search::kNone) models.push_back({i, view.view, view.distance, nullptr, {}, Search::kNone});
  }
  std::sort(models.begin(), models.end(), [](const SketchedModel& a, const SketchedModel& b) {
    return Neighbour{a.view, a.distance} < Neighbour{b.view, b.distance};
  });
  if (models.size() > AlignedNaming::kModelsEach) models.resize(AlignedNaming::kModelsEach);
  return models;
}

bool fitsBetter(const SketchedModel* a, const SketchedModel* b) { return a->misfit() < b->misfit(); }

/// Of each category the kDrawnEach candidates that fit best.
std::vector<SketchedModel*> bestFitting(const Index& index, std::vector<SketchedModel>& candidates) {
  std::vector<SketchedModel*> fitting, best;
  for (SketchedModel& candidate : candidates) {
    if (!candidate.sketches.empty()) fitting.push_back(&candidate);
  }
  std::stable_sort(fitting.begin(), fitting.end(), fitsBetter);
  std::map<std::uint32_t, std::size_t> taken;  // by category
  for (SketchedModel* const candidate : fitting) {
    if (taken[categoryOfModel(index, candidate->model)]++ < AlignedNaming::kDrawnEach) best.push_back(candidate);
  }
  return best;
}

/// What is known about a category that was compared.
struct Compared {
  std::uint32_t category;
  Neighbour nearest;
  std::uint32_t drawn_distance;
  const SketchedModel* best;
  double score = 0;
};

std::vector<Compared> compare(const Index& index, const std::vector<SketchedModel>& candidates) {
  std::vector<Compared> compared;
  for (const SketchedModel& candidate : candidates) {
    const std::uint32_t category = categoryOfModel(index, candidate.model);
    const Neighbour view{candidate.view, candidate.distance};
    const auto known =
        std::find_if(compared.begin(), compared.end(), [&](const Compared& c) { return c.category == category; });
    if (known == compared.end()) {
      compared.push_back({category, view, candidate.drawn_distance, &candidate});
      continue;
    }
    known->nearest = std::min(known->nearest, view);
    known->drawn_distance = std::min(known->drawn_distance, candidate.drawn_distance);
    if (candidate.misfit() < known->best->misfit()) known->best = &candidate;
  }
  return compared;
}

void score(const Index& index, std::uint32_t nearest_distance, const NamingWeights& weights,
           std::vector<Compared>& compared) {
  const auto log = [](auto x) { return std::log(std::max(static_cast<double>(x), 1e-3)); };
  const auto ratio = [&](std::uint32_t distance) {
    return log(std::max(distance, 1u)) - log(std::max(nearest_distance, 1u));
  };
  for (Compared& c : compared) {
    const std::uint32_t drawn = c.drawn_distance == Search::kNone ? c.nearest.distance : c.drawn_distance;
    c.score = -weights.distance * ratio(c.nearest.distance) - weights.misfit * log(c.best->misfit()) -
              weights.drawn * ratio(drawn) + weights.models * log(index.categories()[c.category].models);
  }
  std::stable_sort(compared.begin(), compared.end(),
                   [](const Compared& a, const Compared& b) { return a.score > b.score; });
}

/// Scores as chances that add up to `all`.
std::vector<double> chancesOf(const std::vector<Compared>& compared, double all) {
  std::vector<double> chances;
  double sum = 0;
  for (const Compared& c : compared) {
    chances.push_back(std::exp(c.score - compared.front().score));
    sum += chances.back();
  }
  for (double& chance : chances) chance *= all / sum;
  return chances;
}

bool lists(const Answer& answer, std::uint32_t category) {
  const auto* const end = answer.alternatives.data() + answer.count;
  return std::any_of(answer.alternatives.data(), end, [&](const Alternative& a) { return a.category == category; });
}

void appendOthers(const Index& index, const Nearest& nearest, Answer& answer) {
  for (const Neighbour& view : nearest.categories) {
    if (answer.count == Answer::kMaxAlternatives) return;
    const std::uint32_t category = categoryOfModel(index, index.modelOf(view.view));
    if (!isCategory(index, category) || lists(answer, category)) continue;
    answer.alternatives[static_cast<std::size_t>(answer.count++)] = {category, view.view, view.distance, 0};
  }
}

}  // namespace

Result<std::vector<SketchedModel>> AlignedNaming::candidates(const std::uint8_t* code, const Nearest& nearest) {
  std::copy_n(code, query_.size(), query_.begin());
  std::vector<SketchedModel> readable;
  Status unread;
  for (std::size_t i = 0; i < std::min(kCategories, nearest.categories.size); ++i) {
    const std::uint32_t category = categoryOfModel(*index_, index_->modelOf(nearest.categories[i].view));
    if (!isCategory(*index_, category)) continue;
    for (SketchedModel& model : nearestModels(*index_, code, category)) {
      auto read = shelf_.find(model.model);
      if (!read.ok()) {
        if (unread.ok()) unread = read.status;
        continue;
      }
      model.shelved = std::move(read.value);
      readable.push_back(std::move(model));
    }
  }
  if (readable.empty() && !unread.ok()) return unread;
  return readable;
}

void AlignedNaming::sketch(const ObservedObject& object, std::vector<SketchedModel>& candidates) {
  aligner_.observe(object);
  for (SketchedModel& candidate : candidates) candidate.sketches = aligner_.sketch(candidate.shelved->model, kStarts);
  for (SketchedModel* const candidate : bestFitting(*index_, candidates)) draw(*candidate);
}

void AlignedNaming::draw(SketchedModel& candidate) {
  const ObservedObject drawn = aligner_.drawn(candidate.shelved->model, candidate.sketches.front().pose);
  if (encoder_->encode(drawn.depth, drawn.pixels, drawn_code_.data()) != DescribeStatus::Ok) return;
  const std::uint32_t category = categoryOfModel(*index_, candidate.model);
  candidate.drawn_distance = distanceTo(*index_, query_.data(), drawn_code_.data(), category);
}

Answer AlignedNaming::name(const Nearest& nearest, const std::vector<SketchedModel>& candidates,
                           int min_score_permille) const {
  if (candidates.empty() || nearest.views.empty())
    return classify(*index_, nearest, ClassifyMethod::Vote, min_score_permille);
  const NamingWeights weights;
  Answer answer = classify(*index_, nearest, ClassifyMethod::Vote, min_score_permille);
  std::vector<Compared> compared = compare(*index_, candidates);
  score(*index_, nearest.views[0].distance, weights, compared);
  const std::vector<double> chances = chancesOf(compared, weights.among);
  answer.count = 0;
  for (std::size_t i = 0; i < std::min<std::size_t>(compared.size(), Answer::kMaxAlternatives); ++i) {
    answer.alternatives[static_cast<std::size_t>(answer.count++)] = {compared[i].category, compared[i].best->view,
                                                                     compared[i].best->distance,
                                                                     static_cast<std::uint16_t>(1000 * chances[i])};
  }
  appendOthers(*index_, nearest, answer);
  answer.score_permille = answer.alternatives[0].score_permille;
  answer.known = answer.score_permille >= min_score_permille;
  return answer;
}

AlignedNaming::Posed AlignedNaming::pose(const std::vector<SketchedModel>& candidates, std::uint32_t category) {
  std::vector<const SketchedModel*> fitting;
  for (const SketchedModel& candidate : candidates) {
    if (categoryOfModel(*index_, candidate.model) == category && !candidate.sketches.empty())
      fitting.push_back(&candidate);
  }
  std::stable_sort(fitting.begin(), fitting.end(), fitsBetter);
  Posed best;
  for (std::size_t i = 0; i < std::min(kPosedModels, fitting.size()); ++i) {
    const SketchedModel& model = *fitting[i];
    const Alignment alignment =
        aligner_.finish(model.shelved->model, {model.sketches.data(), std::min(kPosedSketches, model.sketches.size())});
    if (!alignment.found || (best.alignment.found && best.alignment.misfit <= alignment.misfit)) continue;
    best = {&model, alignment};
  }
  return best;
}

}  // namespace voxid
