// SPDX-License-Identifier: BSD-3-Clause
// Exact search of profile "paper" that compares in full only what the sketches do not rule out.
#include <algorithm>
#include <memory>
#include <utility>

#include "rank.h"
#include "voxid/core/sketch.h"

namespace voxid {
namespace {

constexpr std::size_t kEnoughCategories = 10;  // as many as an answer lists and its score looks at

class SketchSearch : public Search {
 public:
  explicit SketchSearch(std::shared_ptr<const Index> index)
      : index_(std::move(index)),
        sketches_(sketchesOf(*index_)),
        views_(static_cast<std::uint32_t>(sketches_.size / kSketchBytes)),
        scope_(*index_),
        bounds_(new std::uint16_t[views_]),
        rows_(new std::uint32_t[views_]),
        compared_(new Rank[views_]),
        answer_(*index_) {}

  const Nearest& find(const std::uint8_t* code, const SearchScope& scope) override {
    scope_ = Scope(*index_, scope);
    bound(code);
    for (std::size_t pool = kCategoryPool;; pool *= 2) {
      Rank* const first = compared_.get();
      Rank* const settled = within(settle(pool, code));
      answer_.meet({first, static_cast<std::size_t>(settled - first)});
      if (answer_.metCategories() >= kEnoughCategories || all_taken_) return answer_.of(first, settled, count_);
    }
  }

 private:
  void bound(const std::uint8_t* code) {
    constexpr std::uint32_t kBlock = 4096;
    const SketchQuery query = sketchQueryOf(code);
    for (std::uint32_t view = 0; view < views_; view += kBlock) {
      const std::uint32_t count = std::min(kBlock, views_ - view);
      lowerBounds(query, sketches_.data + std::size_t{view} * kSketchBytes, count, &bounds_[view]);
    }
    putLastWhatIsOutside();
    counts_.clear();
    counts_.add(Span<const std::uint16_t>{bounds_.get(), views_});
    count_ = 0;
    taken_ = 0;
    all_taken_ = false;
  }

  void putLastWhatIsOutside() {
    for (const format::Model& model : index_->models()) {
      const std::uint64_t end = std::uint64_t{model.first_view} + model.views;
      if (!scope_.has(model) && end <= views_) std::fill(&bounds_[model.first_view], &bounds_[0] + end, UINT16_MAX);
    }
  }

  // A distance up to which every view was compared, and `pool` views lie (or all). First the views with the lowest
  // bounds are compared: the pool-th nearest of them is no nearer than that of all views. So no view whose bound is
  // above that distance is among the `pool` nearest.
  std::uint32_t settle(std::size_t pool, const std::uint8_t* code) {
    takeUpTo(counts_.limitFor(pool), code);
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
      count_ += scope_.has(view) && answer_.categoryOf(view) != kNone;
    }
  }

  // Brings the compared views within `limit` to the front, which none outside can come before; their end.
  Rank* within(std::uint32_t limit) {
    Rank* const first = compared_.get();
    return std::partition(first, first + count_, [limit](Rank rank) { return distanceOf(rank) <= limit; });
  }

  std::shared_ptr<const Index> index_;
  Span<const std::uint8_t> sketches_;
  std::uint32_t views_;
  Scope scope_;
  // Not written to beforehand, so that what is not used is not there.
  std::unique_ptr<std::uint16_t[]> bounds_;
  DistanceCounts<6, UINT16_MAX> counts_;
  std::uint32_t taken_ = 0;  // views with lower bounds were compared
  bool all_taken_ = false;
  std::unique_ptr<std::uint32_t[]> rows_;  // of one step
  std::unique_ptr<Rank[]> compared_;
  std::size_t count_ = 0;
  RankedAnswer answer_;
};

}  // namespace

std::unique_ptr<Search> makeSketchSearch(std::shared_ptr<const Index> index) {
  return std::make_unique<SketchSearch>(std::move(index));
}

}  // namespace voxid
