// SPDX-License-Identifier: BSD-3-Clause
// What the searches share that compare only some of the views.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "voxid/core/search.h"

namespace voxid {

/// A neighbour as one number, whose order is that of neighbours.
using Rank = std::uint64_t;
inline Rank rankOf(std::uint32_t view, std::uint32_t distance) { return Rank{distance} << 32 | view; }
inline std::uint32_t viewOf(Rank rank) { return static_cast<std::uint32_t>(rank); }
inline std::uint32_t distanceOf(Rank rank) { return static_cast<std::uint32_t>(rank >> 32); }
inline Neighbour neighbourOf(Rank rank) { return {viewOf(rank), distanceOf(rank)}; }

/// How many views lie how far away, in steps of 2^kStepBits: what is near enough is found without sorting what is not.
template <int kStepBits, std::uint32_t kMostDistance>
class DistanceCounts {
 public:
  void clear() { counts_.fill(0); }
  template <typename Distance>
  void add(Span<const Distance> distances) {
    for (const std::uint32_t distance : distances) ++counts_[std::min(distance, kMostDistance) >> kStepBits];
  }
  /// A distance up to which at least `count` views lie, or all of them.
  std::uint32_t limitFor(std::size_t count) const {
    std::size_t sum = 0;
    for (std::uint32_t step = 0; step + 1 < counts_.size(); ++step) {
      sum += counts_[step];
      if (sum >= count) return ((step + 1) << kStepBits) - 1;
    }
    return UINT32_MAX;
  }

 private:
  std::array<std::uint32_t, (kMostDistance >> kStepBits) + 1> counts_;
};

/// Which views of one index are in scope.
class Scope {
 public:
  explicit Scope(const Index& index, const SearchScope& scope = {}) : index_(&index), categories_(scope.categories) {
    if (scope.left_out_model >= index.models().size) return;
    left_out_ = index.models()[scope.left_out_model];
  }

  /// In scope; at most all, whatever the models of a damaged file claim.
  std::uint64_t views() const {
    if (categories_.empty()) return index_->viewCount();
    std::uint64_t views = 0;
    for (const format::Model& model : index_->models()) views += has(model) ? model.views : 0;
    return std::min<std::uint64_t>(views, index_->viewCount());
  }
  /// `view` is below the index's viewCount().
  bool has(std::uint32_t view) const { return !leavesOut(view) && (categories_.empty() || inCategories(view)); }
  bool hasAllCategories() const { return categories_.empty(); }
  /// All that has() says where all categories are in scope.
  bool leavesOut(std::uint32_t view) const { return view - left_out_.first_view < left_out_.views; }
  bool has(const format::Model& model) const {
    const bool left_out = left_out_.views > 0 && model.first_view == left_out_.first_view;
    return !left_out &&
           (categories_.empty() || (model.category < categories_.size && categories_[model.category] != 0));
  }

 private:
  bool inCategories(std::uint32_t view) const {
    const std::uint32_t model = index_->modelOf(view);
    return model < index_->models().size && has(index_->models()[model]);
  }

  const Index* index_;
  Span<const std::uint8_t> categories_;
  format::Model left_out_{};  // has no views if none is
};

/// Makes an answer of ranks in any order. All memory is taken at construction.
class RankedAnswer {
 public:
  explicit RankedAnswer(const Index& index) : index_(index), nearest_of_(index.categories().size, kNothing) {
    met_.reserve(nearest_of_.size());
    categories_.reserve(nearest_of_.size());
  }

  /// Search::kNone for a view that leads nowhere, possible only in a damaged file.
  std::uint32_t categoryOf(std::uint32_t view) const {
    const std::uint32_t model = index_.modelOf(view);
    if (model >= index_.models().size) return Search::kNone;
    const std::uint32_t category = index_.models()[model].category;
    return category < nearest_of_.size() ? category : Search::kNone;
  }

  /// Of each category that these views belong to, the nearest view; those of before are forgotten.
  void meet(Span<const Rank> ranks) {
    met_.clear();
    for (const Rank rank : ranks) {
      const std::uint32_t category = categoryOf(viewOf(rank));
      if (category == Search::kNone) continue;
      if (nearest_of_[category] == kNothing) met_.push_back(category);
      nearest_of_[category] = std::min(nearest_of_[category], rank);
    }
    categories_.clear();
    for (const std::uint32_t category : met_)
      categories_.push_back(neighbourOf(std::exchange(nearest_of_[category], kNothing)));
  }
  std::size_t metCategories() const { return met_.size(); }

  /// The nearest of the views from `first` to before `last`, whose order it changes, and the categories met last.
  const Nearest& of(Rank* first, Rank* last, std::size_t scanned) {
    const std::size_t views = std::min<std::size_t>(static_cast<std::size_t>(last - first), kNearestViews);
    std::partial_sort(first, first + views, last);
    std::transform(first, first + views, views_.begin(), neighbourOf);
    std::sort(categories_.begin(), categories_.end());
    nearest_ = {{views_.data(), views}, {categories_.data(), categories_.size()}, static_cast<std::uint32_t>(scanned)};
    return nearest_;
  }

 private:
  static constexpr Rank kNothing = UINT64_MAX;

  const Index& index_;
  std::vector<Rank> nearest_of_;  // by category; kNothing between calls
  std::vector<std::uint32_t> met_;
  std::array<Neighbour, kNearestViews> views_;
  std::vector<Neighbour> categories_;
  Nearest nearest_;
};

}  // namespace voxid
