// SPDX-License-Identifier: BSD-3-Clause
// Search of profile "default": a code's list is its hash, learnt from the codes themselves, and near lists are probed.
#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "code_distance.h"
#include "rank.h"
#include "voxid/core/search.h"

namespace voxid {
namespace {

constexpr std::size_t kEnoughCategories = 5;

class ListSearch : public Search {
 public:
  ListSearch(std::shared_ptr<const Index> index, int lists)
      : index_(std::move(index)),
        least_lists_(static_cast<std::size_t>(std::max(lists, 1))),
        rows_(new std::uint32_t[index_->viewCount()]),
        distances_(new std::uint32_t[index_->viewCount()]),
        scope_(*index_),
        near_(new Rank[index_->viewCount()]),
        answer_(*index_) {
    centroid_distances_.resize(index_->projection()->lists());
    buckets_.reserve(index_->keys().size);
  }

  const Nearest& find(const std::uint8_t* code, const SearchScope& scope) override {
    order(code);
    scope_ = Scope(*index_, scope);
    count_ = 0;
    counts_.clear();
    std::size_t probed = 0, until = listsInScope();
    do {
      until = std::min(until, buckets_.size());
      sortTo(until);
      const std::size_t before = count_;
      for (; probed < until; ++probed) take(static_cast<std::uint32_t>(buckets_[probed]));
      compare(before, code);
      gather();
      until *= 2;
    } while (answer_.metCategories() < kEnoughCategories && probed < buckets_.size());
    return answer_.of(near_.get(), near_.get() + near_count_, count_);
  }

 private:
  // With part of the views in scope as many more lists, so that as many views are compared as without.
  std::size_t listsInScope() const {
    const std::uint64_t lists =
        std::uint64_t{least_lists_} * index_->viewCount() / std::max<std::uint64_t>(1, scope_.views());
    return static_cast<std::size_t>(std::min<std::uint64_t>(lists, buckets_.size()));
  }

  // Buckets by their centroids' distances. A key that names no list (possible only in a damaged file) is passed over.
  void order(const std::uint8_t* code) {
    const Projection& projection = *index_->projection();
    squaredDistances(unpackCode(code, index_->parameters().code_bytes), projection.centroids(), projection.lists(),
                     centroid_distances_.data());
    buckets_.clear();
    sorted_ = 0;
    for (std::uint32_t i = 0; i < index_->keys().size; ++i) {
      const Key list = index_->keys()[i];
      if (list < centroid_distances_.size())
        buckets_.push_back(rankOf(i, centroid_distances_[static_cast<std::size_t>(list)]));
    }
  }

  // The nearest `count` buckets stand first, in order.
  void sortTo(std::size_t count) {
    const auto first = buckets_.begin() + static_cast<std::ptrdiff_t>(sorted_),
               middle = buckets_.begin() + static_cast<std::ptrdiff_t>(count);
    if (middle < buckets_.end()) std::nth_element(first, middle, buckets_.end());
    std::sort(first, middle);
    sorted_ = count;
  }

  void take(std::uint32_t bucket) {
    const Scope scope = scope_;  // the loops' own, so that it stays in registers
    if (scope.hasAllCategories())
      takeIf(bucket, [scope](std::uint32_t view) { return !scope.leavesOut(view); });
    else
      takeIf(bucket, [&scope](std::uint32_t view) { return scope.has(view); });
  }

  // A bucket's views that are in scope. Views that are not there, or more than all (possible only in a damaged file),
  // are passed over.
  template <typename InScope>
  void takeIf(std::uint32_t bucket, InScope in_scope) {
    const auto views = static_cast<std::uint32_t>(index_->viewCount());
    for (const std::uint32_t view : index_->bucket(bucket)) {
      if (count_ == views) return;
      rows_[count_] = view;
      count_ += view < views && in_scope(view);
    }
  }

  void compare(std::size_t first, const std::uint8_t* code) {
    squaredDistancesAt(code, index_->code(0), rows_.get() + first, count_ - first, index_->parameters().code_bytes,
                       distances_.get() + first);
    counts_.add(Span<const std::uint32_t>{distances_.get() + first, count_ - first});
  }

  // Categories among the nearest, more of them until enough are met.
  void gather() {
    for (std::size_t pool = kCategoryPool;; pool *= 2) {
      collect(counts_.limitFor(pool));
      answer_.meet({near_.get(), near_count_});
      if (answer_.metCategories() >= kEnoughCategories || near_count_ == count_) return;
    }
  }

  // Written whether it is kept or not: no branch to be foretold.
  void collect(std::uint32_t limit) {
    near_count_ = 0;
    for (std::size_t i = 0; i < count_; ++i) {
      near_[near_count_] = rankOf(rows_[i], distances_[i]);
      near_count_ += distances_[i] <= limit;
    }
  }

  std::shared_ptr<const Index> index_;
  std::size_t least_lists_;
  std::vector<std::uint32_t> centroid_distances_;
  std::vector<Rank> buckets_;  // numbers of buckets, with their centroids' distances
  std::size_t sorted_ = 0;
  // Room for all views, in case it takes all of them; not written to beforehand, so that what is not used is not there.
  std::unique_ptr<std::uint32_t[]> rows_, distances_;  // of the views compared
  std::size_t count_ = 0;
  Scope scope_;
  DistanceCounts<10, kMostCodeDistance> counts_;
  std::unique_ptr<Rank[]> near_;  // the views that may be among the nearest
  std::size_t near_count_ = 0;
  RankedAnswer answer_;
};

}  // namespace

std::unique_ptr<Search> makeListSearch(std::shared_ptr<const Index> index, int lists) {
  return std::make_unique<ListSearch>(std::move(index), lists);
}

}  // namespace voxid
