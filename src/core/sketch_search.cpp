// SPDX-License-Identifier: BSD-3-Clause
// Exact search of profile "paper" that compares in full only what the sketches do not rule out.
#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "voxid/core/sketch.h"

namespace voxid {
namespace {

constexpr std::size_t kEnoughCategories = 10;  // as many as an answer lists and its score looks at

// A neighbour as one number, whose order is that of neighbours.
using Rank = std::uint64_t;
Rank rankOf(std::uint32_t view, std::uint32_t distance) { return Rank{distance} << 32 | view; }
std::uint32_t viewOf(Rank rank) { return static_cast<std::uint32_t>(rank); }
std::uint32_t distanceOf(Rank rank) { return static_cast<std::uint32_t>(rank >> 32); }
Neighbour neighbourOf(Rank rank) { return {viewOf(rank), distanceOf(rank)}; }

// How many views have which bound, in steps of 64.
class BoundCounts {
 public:
  void clear() { counts_.fill(0); }
  void add(Span<const std::uint16_t> bounds) {
    for (const std::uint16_t bound : bounds) ++counts_[bound >> kStepBits];
  }
  // A bound up to which `count` views lie, or all of them.
  std::uint32_t limitFor(std::size_t count) const {
    std::size_t step = 0;
    for (std::size_t sum = 0; step + 1 < counts_.size(); ++step) {
      sum += counts_[step];
      if (sum >= count) break;
    }
    return static_cast<std::uint32_t>(((step + 1) << kStepBits) - 1);
  }

 private:
  static constexpr int kStepBits = 6;
  std::array<std::uint32_t, (UINT16_MAX >> kStepBits) + 1> counts_;
};

class SketchSearch : public Search {
 public:
  explicit SketchSearch(std::shared_ptr<const Index> index)
      : index_(std::move(index)),
        sketches_(sketchesOf(*index_)),
        views_(static_cast<std::uint32_t>(sketches_.size / kSketchBytes)),
        bounds_(new std::uint16_t[views_]),
        rows_(new std::uint32_t[views_]),
        compared_(new Rank[views_]),
        nearest_of_(index_->categories().size, kNothing) {
    met_.reserve(index_->categories().size);
    categories_.reserve(index_->categories().size);
  }

  const Nearest& find(const std::uint8_t* code, std::uint32_t left_out_model) override {
    leaveOut(left_out_model);
    bound(code);
    for (std::size_t pool = kCategoryPool;; pool *= 2) {
      gather(settle(pool, code));
      if (met_.size() >= kEnoughCategories || all_taken_) return answer();
    }
  }

 private:
  static constexpr Rank kNothing = UINT64_MAX;

  void leaveOut(std::uint32_t model) {
    const bool none = model >= index_->models().size;
    left_out_first_ = none ? 0 : index_->models()[model].first_view;
    left_out_views_ = none ? 0 : index_->models()[model].views;
  }

  void bound(const std::uint8_t* code) {
    constexpr std::uint32_t kBlock = 4096;
    const SketchQuery query = sketchQueryOf(code);
    counts_.clear();
    for (std::uint32_t view = 0; view < views_; view += kBlock) {
      const std::uint32_t count = std::min(kBlock, views_ - view);
      lowerBounds(query, sketches_.data + std::size_t{view} * kSketchBytes, count, &bounds_[view]);
      counts_.add({&bounds_[view], count});
    }
    count_ = 0;
    taken_ = 0;
    all_taken_ = false;
  }

  // A distance up to which every view was compared, and `pool` views lie (or all). First the views with the lowest
  // bounds are compared: the pool-th nearest of them is no nearer than that of all views. So no view whose bound is
  // above that distance is among the `pool` nearest.
  std::uint32_t settle(std::size_t pool, const std::uint8_t* code) {
    takeUpTo(counts_.limitFor(pool + left_out_views_), code);
    if (count_ < pool) {
      takeUpTo(UINT16_MAX, code);
      return UINT32_MAX;
    }
    Rank* const nth = compared_.get() + pool - 1;
    std::nth_element(compared_.get(), nth, compared_.get() + count_);
    const std::uint32_t limit = distanceOf(*nth);
    takeUpTo(limit, code);
    return limit;
  }

  // Compares the views whose bounds are at most `limit`, those of before excepted.
  void takeUpTo(std::uint32_t limit, const std::uint8_t* code) {
    const std::uint32_t end = std::min<std::uint32_t>(limit, UINT16_MAX) + 1;
    if (end <= taken_) return;
    std::size_t rows = 0;
    for (std::uint32_t view = 0; view < views_; ++view) {
      rows_[rows] = view;  // whether it is kept or not: no branch to be foretold
      rows += bounds_[view] - taken_ < end - taken_;
    }
    taken_ = end;
    all_taken_ = end > UINT16_MAX;
    compare(rows, code);
  }

  void compare(std::size_t rows, const std::uint8_t* code) {
    constexpr std::size_t kAhead = 6, kLine = 64;
    for (std::size_t i = 0; i < rows; ++i) {
      if (i + kAhead < rows) {
        const std::uint8_t* const ahead = index_->code(rows_[i + kAhead]);
        for (std::size_t byte = 0; byte < kDescriptorBytes; byte += kLine) __builtin_prefetch(ahead + byte);
      }
      const std::uint32_t view = rows_[i];
      compared_[count_] = rankOf(view, l1(code, index_->code(view)));
      count_ += view - left_out_first_ >= left_out_views_ && categoryOf(view) != kNone;
    }
  }

  // Of each category that lies within `limit`, its nearest view.
  void gather(std::uint32_t limit) {
    Rank* const first = compared_.get();
    settled_ = std::partition(first, first + count_, [limit](Rank rank) { return distanceOf(rank) <= limit; });
    met_.clear();
    for (const Rank* rank = first; rank != settled_; ++rank) {
      const std::uint32_t category = categoryOf(viewOf(*rank));
      if (nearest_of_[category] == kNothing) met_.push_back(category);
      nearest_of_[category] = std::min(nearest_of_[category], *rank);
    }
    categories_.clear();
    for (const std::uint32_t category : met_)
      categories_.push_back(neighbourOf(std::exchange(nearest_of_[category], kNothing)));
  }

  const Nearest& answer() {
    Rank* const first = compared_.get();
    const std::size_t views = std::min<std::size_t>(static_cast<std::size_t>(settled_ - first), kNearestViews);
    std::partial_sort(first, first + views, settled_);
    std::transform(first, first + views, nearest_.begin(), neighbourOf);
    std::sort(categories_.begin(), categories_.end());
    result_ = {{nearest_.data(), views}, {categories_.data(), categories_.size()}, static_cast<std::uint32_t>(count_)};
    return result_;
  }

  // kNone for a view that leads nowhere, possible only in a damaged file.
  std::uint32_t categoryOf(std::uint32_t view) const {
    const std::uint32_t model = index_->modelOf(view);
    if (model >= index_->models().size) return kNone;
    const std::uint32_t category = index_->models()[model].category;
    return category < nearest_of_.size() ? category : kNone;
  }

  std::shared_ptr<const Index> index_;
  Span<const std::uint8_t> sketches_;
  std::uint32_t views_;
  std::uint32_t left_out_first_ = 0, left_out_views_ = 0;
  // Not written to beforehand, so that what is not used is not there.
  std::unique_ptr<std::uint16_t[]> bounds_;
  BoundCounts counts_;
  std::uint32_t taken_ = 0;  // views with lower bounds were compared
  bool all_taken_ = false;
  std::unique_ptr<std::uint32_t[]> rows_;  // of one step
  std::unique_ptr<Rank[]> compared_;
  std::size_t count_ = 0;
  Rank* settled_ = nullptr;       // behind the compared views that none outside can come before
  std::vector<Rank> nearest_of_;  // by category; kNothing between calls
  std::vector<std::uint32_t> met_;
  std::array<Neighbour, kNearestViews> nearest_;
  std::vector<Neighbour> categories_;
  Nearest result_;
};

}  // namespace

std::unique_ptr<Search> makeSketchSearch(std::shared_ptr<const Index> index) {
  return std::make_unique<SketchSearch>(std::move(index));
}

}  // namespace voxid
