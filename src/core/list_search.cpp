// SPDX-License-Identifier: BSD-3-Clause
// Search of profile "default": a code's list is its hash, learnt from the codes themselves, and near lists are probed.
#include <algorithm>
#include <array>
#include <memory>
#include <utility>

#include "code_distance.h"
#include "voxid/core/search.h"

namespace voxid {
namespace {

constexpr std::size_t kEnoughCategories = 5;

// A neighbour as one number, whose order is that of neighbours.
using Rank = std::uint64_t;
Rank rankOf(std::uint32_t view, std::uint32_t distance) { return Rank{distance} << 32 | view; }
Neighbour neighbourOf(Rank rank) { return {static_cast<std::uint32_t>(rank), static_cast<std::uint32_t>(rank >> 32)}; }

// How many views lie how far away, in steps of 1,024: what is near enough is found without sorting what is not.
class DistanceCounts {
 public:
  void clear() { counts_.fill(0); }
  void add(Span<const std::uint32_t> distances) {
    for (const std::uint32_t distance : distances) ++counts_[stepOf(distance)];
  }
  // A distance below which `count` views lie, or all of them.
  std::uint32_t limitFor(std::size_t count) const {
    std::size_t step = 0;
    for (std::size_t sum = 0; step < counts_.size(); ++step) {
      sum += counts_[step];
      if (sum >= count) break;
    }
    return step + 1 < counts_.size() ? static_cast<std::uint32_t>((step + 1) << kStepBits) : UINT32_MAX;
  }

 private:
  static constexpr int kStepBits = 10;
  static constexpr std::uint32_t kMostDistance = 64 * 254 * 254;
  static std::size_t stepOf(std::uint32_t distance) { return std::min(distance, kMostDistance) >> kStepBits; }
  std::array<std::uint32_t, (kMostDistance >> kStepBits) + 1> counts_;
};

class ListSearch : public Search {
 public:
  ListSearch(std::shared_ptr<const Index> index, int lists)
      : index_(std::move(index)),
        least_lists_(static_cast<std::size_t>(std::max(lists, 1))),
        rows_(new std::uint32_t[index_->viewCount()]),
        distances_(new std::uint32_t[index_->viewCount()]),
        near_(new Rank[index_->viewCount()]),
        nearest_of_(index_->categories().size, kNothing) {
    centroid_distances_.resize(index_->projection()->lists());
    buckets_.reserve(index_->keys().size);
    met_.reserve(index_->categories().size);
    categories_.reserve(index_->categories().size);
  }

  const Nearest& find(const std::uint8_t* code, std::uint32_t left_out_model) override {
    order(code);
    leaveOut(left_out_model);
    count_ = 0;
    counts_.clear();
    std::size_t probed = 0, until = least_lists_;
    do {
      until = std::min(until, buckets_.size());
      sortTo(until);
      const std::size_t before = count_;
      for (; probed < until; ++probed) take(static_cast<std::uint32_t>(buckets_[probed]));
      compare(before, code);
      gather();
      until *= 2;
    } while (met_.size() < kEnoughCategories && probed < buckets_.size());
    return answer();
  }

 private:
  static constexpr Rank kNothing = UINT64_MAX;

  // Buckets by their centroids' distances. A key that names no list (possible only in a damaged file) is passed over.
  void order(const std::uint8_t* code) {
    const Projection& projection = *index_->projection();
    squaredDistances(code, projection.centroids(), projection.lists(), projection.codeBytes(),
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

  void leaveOut(std::uint32_t model) {
    const bool none = model >= index_->models().size;
    left_out_first_ = none ? 0 : index_->models()[model].first_view;
    left_out_views_ = none ? 0 : index_->models()[model].views;
  }

  // A bucket's views, less those left out. Views that are not there, or more than all (possible only in a damaged
  // file), are passed over.
  void take(std::uint32_t bucket) {
    const auto views = static_cast<std::uint32_t>(index_->viewCount());
    for (const std::uint32_t view : index_->bucket(bucket)) {
      if (count_ == views) return;
      rows_[count_] = view;
      count_ += view < views && view - left_out_first_ >= left_out_views_;
    }
  }

  void compare(std::size_t first, const std::uint8_t* code) {
    squaredDistancesAt(code, index_->code(0), rows_.get() + first, count_ - first, index_->parameters().code_bytes,
                       distances_.get() + first);
    counts_.add({distances_.get() + first, count_ - first});
  }

  // Categories among the nearest, more of them until enough are met.
  void gather() {
    for (std::size_t pool = kCategoryPool;; pool *= 2) {
      collect(counts_.limitFor(pool));
      meet();
      if (met_.size() >= kEnoughCategories || near_count_ == count_) return;
    }
  }

  // Written whether it is kept or not: no branch to be foretold.
  void collect(std::uint32_t limit) {
    near_count_ = 0;
    for (std::size_t i = 0; i < count_; ++i) {
      near_[near_count_] = rankOf(rows_[i], distances_[i]);
      near_count_ += distances_[i] < limit;
    }
  }

  void meet() {
    met_.clear();
    for (std::size_t i = 0; i < near_count_; ++i) {
      const Rank rank = near_[i];
      const std::uint32_t category = categoryOf(neighbourOf(rank).view);
      if (category >= nearest_of_.size()) continue;
      if (nearest_of_[category] == kNothing) met_.push_back(category);
      nearest_of_[category] = std::min(nearest_of_[category], rank);
    }
    categories_.clear();
    for (const std::uint32_t category : met_) {
      categories_.push_back(neighbourOf(nearest_of_[category]));
      nearest_of_[category] = kNothing;
    }
  }

  const Nearest& answer() {
    const std::size_t views = std::min<std::size_t>(near_count_, kNearestViews);
    Rank* const first = near_.get();
    Rank* const nth = first + views;
    std::partial_sort(first, nth, first + near_count_);
    std::transform(first, nth, views_.begin(), neighbourOf);
    std::sort(categories_.begin(), categories_.end());
    result_ = {{views_.data(), views}, {categories_.data(), categories_.size()}, static_cast<std::uint32_t>(count_)};
    return result_;
  }

  // kNone for a view that leads nowhere, possible only in a damaged file.
  std::uint32_t categoryOf(std::uint32_t view) const {
    const std::uint32_t model = index_->modelOf(view);
    return model < index_->models().size ? index_->models()[model].category : kNone;
  }

  std::shared_ptr<const Index> index_;
  std::size_t least_lists_;
  std::vector<std::uint32_t> centroid_distances_;
  std::vector<Rank> buckets_;  // numbers of buckets, with their centroids' distances
  std::size_t sorted_ = 0;
  std::uint32_t left_out_first_ = 0, left_out_views_ = 0;
  // Room for all views, in case it takes all of them; not written to beforehand, so that what is not used is not there.
  std::unique_ptr<std::uint32_t[]> rows_, distances_;  // of the views compared
  std::size_t count_ = 0;
  DistanceCounts counts_;
  std::unique_ptr<Rank[]> near_;  // the views that may be among the nearest
  std::size_t near_count_ = 0;
  std::vector<Rank> nearest_of_;  // by category; kNothing between calls
  std::vector<std::uint32_t> met_;
  std::array<Neighbour, kNearestViews> views_;
  std::vector<Neighbour> categories_;
  Nearest result_;
};

}  // namespace

std::unique_ptr<Search> makeListSearch(std::shared_ptr<const Index> index, int lists) {
  return std::make_unique<ListSearch>(std::move(index), lists);
}

}  // namespace voxid
