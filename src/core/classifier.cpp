// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/core/classifier.h"

#include <algorithm>

#include "vote.h"
#include "voxid/core/confidence.h"

namespace voxid {
namespace {

constexpr std::uint32_t kAllPermille = 1000;

struct Candidate {
  std::uint32_t category = kNoCategory;
  Neighbour nearest;
  std::uint64_t weight = 0;
};

bool ranksBefore(const Candidate& a, const Candidate& b) {
  if (a.weight != b.weight) return a.weight > b.weight;
  if (a.nearest.distance != b.nearest.distance) return a.nearest.distance < b.nearest.distance;
  return a.category < b.category;
}

// Categories, at most as many as an answer lists.
class Ranking {
 public:
  // The category's weight grows. `nearest` counts only where the category is new: votes come in the order of distance.
  void vote(std::uint32_t category, Neighbour nearest, std::uint64_t weight) {
    if (category == kNoCategory) return;
    Candidate* const known = find(category);
    if (known != end()) {
      known->weight += weight;
    } else if (count_ < candidates_.size()) {
      candidates_[count_++] = {category, nearest, weight};
    }
  }
  void sort() { std::sort(begin(), end(), ranksBefore); }

  // Behind the others, never heavier than the last of them.
  void append(std::uint32_t category, Neighbour nearest, std::uint64_t weight) {
    if (find(category) != end()) return;
    vote(category, nearest, count_ == 0 ? weight : std::min(weight, candidates_[count_ - 1].weight));
  }

  Candidate* begin() { return candidates_.data(); }
  Candidate* end() { return candidates_.data() + count_; }
  bool full() const { return count_ == candidates_.size(); }

 private:
  Candidate* find(std::uint32_t category) {
    return std::find_if(begin(), end(), [category](const Candidate& c) { return c.category == category; });
  }

  std::array<Candidate, Answer::kMaxAlternatives> candidates_;
  std::size_t count_ = 0;
};

// Views of one model say nearly the same: each model has one vote, that of its nearest view.
class Voters {
 public:
  bool isNew(std::uint32_t model) {
    const auto end = models_.begin() + static_cast<std::ptrdiff_t>(count_);
    if (count_ == models_.size() || std::find(models_.begin(), end, model) != end) return false;
    models_[count_++] = model;
    return true;
  }

 private:
  std::array<std::uint32_t, kNearestViews> models_;
  std::size_t count_ = 0;
};

Ranking rank(const Index& index, const Nearest& nearest, std::size_t views) {
  Ranking ranking;
  Voters voters;
  const std::uint32_t d1 = nearest.views[0].distance;
  for (std::size_t i = 0; i < std::min(views, nearest.views.size); ++i) {
    const Neighbour view = nearest.views[i];
    const std::uint32_t category = categoryOf(index, view);
    if (category != kNoCategory && voters.isNew(index.modelOf(view.view)))
      ranking.vote(category, view, voteOf(view.distance, d1));
  }
  ranking.sort();
  for (const Neighbour& view : nearest.categories) {
    if (ranking.full()) break;
    ranking.append(categoryOf(index, view), view, voteOf(view.distance, d1));
  }
  return ranking;
}

// parts x (d2 - d1) / d2 of the two nearest categories; `parts` if there is one only.
std::uint32_t marginOf(Span<const Neighbour> categories, std::uint32_t parts) {
  if (categories.size < 2) return parts;
  const std::uint32_t d1 = categories[0].distance, d2 = categories[1].distance;
  return d2 == 0 ? 0 : static_cast<std::uint32_t>(std::uint64_t{parts} * (d2 - d1) / d2);
}

// By the curve, a vote that goes against the nearest category has no margin.
std::uint32_t scoreOf(const Index& index, const Nearest& nearest, std::uint32_t first_category) {
  if (const format::Confidence* const confidence = index.confidence(); confidence != nullptr)
    return confidencePermille(*confidence, confidenceFeatures(index, nearest, first_category));
  constexpr std::uint32_t kBins = format::Calibration::kBins;
  const bool agrees = first_category == categoryOf(index, nearest.categories[0]);
  const std::uint32_t bin = agrees ? std::min(marginOf(nearest.categories, kBins), kBins - 1) : 0;
  return std::min<std::uint32_t>(index.calibration().score_permille[bin], kAllPermille);
}

// What the first leaves is shared by weight; no share is above the one before it.
void shareRest(Ranking& ranking, Answer& answer) {
  std::uint64_t total = 0;
  for (const Candidate* c = ranking.begin() + 1; c < ranking.end(); ++c) total += c->weight;
  for (int i = 1; i < answer.count && total > 0; ++i) {
    const std::uint64_t share = (kAllPermille - answer.score_permille) * ranking.begin()[i].weight / total;
    const std::uint16_t before = answer.alternatives[i - 1].score_permille;
    answer.alternatives[i].score_permille = static_cast<std::uint16_t>(std::min<std::uint64_t>(share, before));
  }
}

}  // namespace

Answer classify(const Index& index, const Nearest& nearest, ClassifyMethod method, int min_score_permille) {
  Answer answer;
  if (nearest.views.empty() || nearest.categories.empty()) return answer;
  Ranking ranking = rank(index, nearest, method == ClassifyMethod::Vote ? kNearestViews : 1);
  for (const Candidate& c : ranking) {
    answer.alternatives[answer.count++] = {c.category, c.nearest.view, c.nearest.distance, 0};
  }
  if (answer.count == 0) return answer;
  answer.margin_permille = marginOf(nearest.categories, kAllPermille);
  answer.score_permille = static_cast<std::uint16_t>(scoreOf(index, nearest, answer.alternatives[0].category));
  answer.alternatives[0].score_permille = answer.score_permille;
  shareRest(ranking, answer);
  answer.known = answer.score_permille >= min_score_permille;
  return answer;
}

}  // namespace voxid
