// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/core/search.h"

#include <algorithm>
#include <array>
#include <utility>

#include "code_distance.h"
#include "rank.h"
#include "vectorised.h"
#include "voxid/core/refine.h"
#include "voxid/core/sketch.h"

namespace voxid {
namespace {

constexpr std::uint32_t kNotMet = 0xffffffff;
constexpr std::size_t kEnoughCategories = 5;
constexpr int kBallStepBits = 2;

VOXID_VECTORISED std::uint32_t leastOf(const std::uint32_t* distances, std::size_t count) {
  std::uint32_t least = UINT32_MAX;
  for (std::size_t i = 0; i < count; ++i) least = std::min(least, distances[i]);
  return least;
}

// The nearest views and each category's nearest, from candidates in any order.
class Gatherer {
 public:
  explicit Gatherer(std::size_t categories) : best_(categories) { met_.reserve(categories); }

  void clear() {
    std::fill(best_.begin(), best_.end(), Neighbour{0, kNotMet});
    met_categories_ = 0;
    count_ = 0;
    scanned_ = 0;
  }

  // `category` is below the number of categories.
  void add(Neighbour candidate, std::uint32_t category) {
    ++scanned_;
    addToCategory(candidate, category);
    addToNearest(candidate);
  }

  // Views of one model, `first` the number of the first: the same as adding one by one, but most are not looked at.
  void addModel(std::uint32_t first, Span<const std::uint32_t> distances, std::uint32_t category) {
    scanned_ += static_cast<std::uint32_t>(distances.size);
    const std::uint32_t least = leastOf(distances.data, distances.size);
    if (least <= best_[category].distance) {
      const auto place = std::find(distances.begin(), distances.end(), least) - distances.begin();
      addToCategory({first + static_cast<std::uint32_t>(place), least}, category);
    }
    if (count_ == kNearestViews && least > nearest_[count_ - 1].distance) return;
    for (std::size_t i = 0; i < distances.size; ++i)
      addToNearest({first + static_cast<std::uint32_t>(i), distances[i]});
  }

  std::size_t metCategories() const { return met_categories_; }

  const Nearest& result() {
    met_.clear();
    for (const Neighbour best : best_) {
      if (best.distance != kNotMet) met_.push_back(best);
    }
    std::sort(met_.begin(), met_.end());
    result_ = {{nearest_.data(), count_}, {met_.data(), met_.size()}, scanned_};
    return result_;
  }

 private:
  void addToCategory(Neighbour candidate, std::uint32_t category) {
    Neighbour& best = best_[category];
    if (!(candidate < best)) return;
    met_categories_ += best.distance == kNotMet;
    best = candidate;
  }

  void addToNearest(Neighbour candidate) {
    if (count_ == kNearestViews && !(candidate < nearest_[count_ - 1])) return;
    if (count_ < kNearestViews) ++count_;
    std::size_t place = count_ - 1;
    for (; place > 0 && candidate < nearest_[place - 1]; --place) nearest_[place] = nearest_[place - 1];
    nearest_[place] = candidate;
  }

  std::vector<Neighbour> best_;  // by category
  std::vector<Neighbour> met_;
  std::array<Neighbour, kNearestViews> nearest_;
  std::size_t count_ = 0, met_categories_ = 0;
  std::uint32_t scanned_ = 0;
  Nearest result_;
};

class ExactSearch : public Search {
 public:
  explicit ExactSearch(std::shared_ptr<const Index> index)
      : index_(std::move(index)), found_(index_->categories().size) {}

  const Nearest& find(const std::uint8_t* code, const SearchScope& scope) override {
    const Scope in_scope(*index_, scope);
    found_.clear();
    for (const format::Model& model : index_->models()) {
      if (in_scope.has(model)) scan(model, code);
    }
    return found_.result();
  }

 private:
  // A model that leads nowhere (possible only in a damaged file) is passed over.
  void scan(const format::Model& model, const std::uint8_t* code) {
    const std::uint64_t end = std::uint64_t{model.first_view} + model.views;
    if (end > index_->viewCount() || model.category >= index_->categories().size) return;
    constexpr std::uint32_t kBlock = 256;
    std::array<std::uint32_t, kBlock> distances;
    for (std::uint32_t view = model.first_view; view < end; view += kBlock) {
      const auto count = static_cast<std::uint32_t>(std::min<std::uint64_t>(kBlock, end - view));
      compare(view, count, code, distances.data());
      found_.addModel(view, {distances.data(), count}, model.category);
    }
  }

  void compare(std::uint32_t first, std::uint32_t count, const std::uint8_t* code, std::uint32_t* distances) const {
    if (index_->projection()) {
      squaredDistances(code, index_->code(first), count, index_->parameters().code_bytes, distances);
    } else {
      for (std::uint32_t i = 0; i < count; ++i) distances[i] = l1(code, index_->code(first + i));
    }
  }

  std::shared_ptr<const Index> index_;
  Gatherer found_;
};

class LshSearch : public Search {
 public:
  LshSearch(std::shared_ptr<const Index> index, int radius_bits)
      : index_(std::move(index)),
        radius_bits_(std::min(std::max(radius_bits, 0), kKeyBits)),
        bits_away_(index_->keys().size),
        found_(index_->categories().size) {}

  const Nearest& find(const std::uint8_t* code, const SearchScope& scope) override {
    const Scope in_scope(*index_, scope);
    measure(keyOf(code));
    found_.clear();
    int radius = radius_bits_;
    scanShell(0, radius, code, in_scope);
    while (found_.metCategories() < kEnoughCategories && radius < kKeyBits) {
      scanShell(radius + 1, radius + kBallStepBits, code, in_scope);
      radius += kBallStepBits;
    }
    return found_.result();
  }

 private:
  void measure(Key key) {
    for (std::size_t i = 0; i < bits_away_.size(); ++i) {
      bits_away_[i] = static_cast<std::uint8_t>(hammingDistance(key, index_->keys()[i]));
    }
  }

  // The buckets whose keys are `first` to `last` bits away.
  void scanShell(int first, int last, const std::uint8_t* code, const Scope& scope) {
    for (std::uint32_t i = 0; i < bits_away_.size(); ++i) {
      if (bits_away_[i] < first || bits_away_[i] > last) continue;
      for (const std::uint32_t view : index_->bucket(i)) consider(view, code, scope);
    }
  }

  // A view that leads nowhere (possible only in a damaged file) is passed over.
  void consider(std::uint32_t view, const std::uint8_t* code, const Scope& scope) {
    if (view >= index_->viewCount() || !scope.has(view)) return;
    const std::uint32_t model = index_->modelOf(view);
    if (model >= index_->models().size) return;
    const std::uint32_t category = index_->models()[model].category;
    if (category < index_->categories().size) found_.add({view, l1(code, index_->code(view))}, category);
  }

  std::shared_ptr<const Index> index_;
  int radius_bits_;
  std::vector<std::uint8_t> bits_away_;  // of every bucket's key from the query's
  Gatherer found_;
};

// Another search's answer by the codes moved towards their categories' means.
class RefinedSearch : public Search {
 public:
  RefinedSearch(std::shared_ptr<const Index> index, std::unique_ptr<Search> search)
      : index_(std::move(index)),
        search_(std::move(search)),
        refiner_(index_->categories().size, index_->parameters().code_bytes),
        others_(index_->parameters().code_bytes) {}

  const Nearest& find(const std::uint8_t* code, const SearchScope& scope) override {
    const Nearest& found = search_->find(code, scope);
    leaveOut(scope.left_out_model);
    return refiner_.refine(code, found, [this](std::uint32_t view) { return moved(view); });
  }

 private:
  // A view that leads nowhere (possible only in a damaged file) has no category.
  Moved moved(std::uint32_t view) const {
    const std::uint32_t model = index_->modelOf(view);
    const std::uint32_t category = model < index_->models().size ? index_->models()[model].category : kNone;
    if (category >= index_->categories().size) return {view, kNone, nullptr, nullptr};
    return {view, category, index_->code(view), meanOf(category)};
  }

  void leaveOut(std::uint32_t model) {
    const bool none = model >= index_->models().size;
    changed_category_ = none ? kNone : index_->models()[model].category;
    if (none) return;
    others_.clear();
    for (std::uint32_t other = 0; other < index_->models().size; ++other) {
      if (other != model && index_->models()[other].category == changed_category_)
        addTo(others_, index_->models()[other]);
    }
    if (!others_.empty()) others_.write(mean_of_others_.data());
  }
  void addTo(CodeMean& mean, const format::Model& model) const {
    const std::uint64_t end =
        std::min(std::uint64_t{model.first_view} + model.views, std::uint64_t{index_->viewCount()});
    for (std::uint32_t view = model.first_view; view < end; ++view) mean.add(index_->code(view));
  }

  const std::int8_t* meanOf(std::uint32_t category) const {
    if (category != changed_category_) return index_->mean(category);
    return others_.empty() ? nullptr : mean_of_others_.data();
  }

  std::shared_ptr<const Index> index_;
  std::unique_ptr<Search> search_;
  Refiner refiner_;
  std::uint32_t changed_category_ = kNone;  // whose mean lacks the model that is left out
  CodeMean others_;
  CodeNumbers mean_of_others_;
};

}  // namespace

std::unique_ptr<Search> makeExactSearch(std::shared_ptr<const Index> index) {
  return std::make_unique<ExactSearch>(std::move(index));
}

std::unique_ptr<Search> makeSearch(std::shared_ptr<const Index> index, const SearchParams& params) {
  if (!index->projection()) {
    const bool exact = params.exact || params.radius_bits < 0;
    if (!exact) return makeLshSearch(std::move(index), params.radius_bits);
    return sketchesOf(*index).empty() ? makeExactSearch(std::move(index)) : makeSketchSearch(std::move(index));
  }
  auto search = params.exact ? makeExactSearch(index) : makeListSearch(index, params.lists);
  return std::make_unique<RefinedSearch>(std::move(index), std::move(search));
}

std::unique_ptr<Search> makeLshSearch(std::shared_ptr<const Index> index, int radius_bits) {
  return std::make_unique<LshSearch>(std::move(index), radius_bits);
}

}  // namespace voxid
