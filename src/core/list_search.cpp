// SPDX-License-Identifier: BSD-3-Clause
// Search of profile "default": a code's list is its hash, learnt from the codes themselves, and near lists are probed.
#include <algorithm>
#include <utility>

#include "code_distance.h"
#include "voxid/core/search.h"

namespace voxid {
namespace {

constexpr std::size_t kEnoughCategories = 5;

class ListSearch : public Search {
 public:
  ListSearch(std::shared_ptr<const Index> index, int lists)
      : index_(std::move(index)),
        least_lists_(static_cast<std::size_t>(std::max(lists, 1))),
        met_(index_->categories().size) {
    const std::size_t buckets = index_->keys().size, views = index_->viewCount();
    centroid_distances_.resize(index_->projection()->lists());
    buckets_.reserve(buckets);
    distances_.resize(longestBucket());
    candidates_.reserve(views);
    categories_.reserve(index_->categories().size);
  }

  const Nearest& find(const std::uint8_t* code, std::uint32_t left_out_model) override {
    order(code);
    candidates_.clear();
    std::size_t probed = 0, until = least_lists_;
    do {
      until = std::min(until, buckets_.size());
      sortTo(until);
      for (; probed < until; ++probed) compare(buckets_[probed].view, code, left_out_model);
      gather();
      until *= 2;
    } while (categories_.size() < kEnoughCategories && probed < buckets_.size());
    return result_;
  }

 private:
  std::size_t longestBucket() const {
    std::size_t longest = 0;
    for (std::uint32_t i = 0; i < index_->keys().size; ++i) longest = std::max(longest, index_->bucket(i).size);
    return longest;
  }

  // Buckets with their centroids' distances. A key that names no list (possible only in a damaged file) is passed over.
  void order(const std::uint8_t* code) {
    const Projection& projection = *index_->projection();
    squaredDistances(code, projection.centroids(), projection.lists(), projection.codeBytes(),
                     centroid_distances_.data());
    buckets_.clear();
    sorted_ = 0;
    for (std::uint32_t i = 0; i < index_->keys().size; ++i) {
      const Key list = index_->keys()[i];
      if (list < centroid_distances_.size())
        buckets_.push_back({i, centroid_distances_[static_cast<std::size_t>(list)]});
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

  void compare(std::uint32_t bucket, const std::uint8_t* code, std::uint32_t left_out_model) {
    const Span<const std::uint32_t> views = index_->bucket(bucket);
    if (!inside(views)) return;
    squaredDistancesAt(code, index_->code(0), views.data, views.size, index_->parameters().code_bytes,
                       distances_.data());
    for (std::size_t i = 0; i < views.size; ++i) {
      if (left_out_model != kNone && index_->modelOf(views[i]) == left_out_model) continue;
      if (candidates_.size() < candidates_.capacity()) candidates_.push_back({views[i], distances_[i]});
    }
  }

  // False only in a damaged file.
  bool inside(Span<const std::uint32_t> views) const {
    return views.size <= distances_.size() &&
           std::all_of(views.begin(), views.end(), [&](std::uint32_t view) { return view < index_->viewCount(); });
  }

  void gather() {
    std::size_t pool = 0;
    categories_.clear();
    do {
      const std::size_t before = pool;
      pool = std::min(std::max<std::size_t>(2 * pool, kListPool), candidates_.size());
      sortCandidates(before, pool);
      for (std::size_t i = before; i < pool; ++i) meet(candidates_[i]);
    } while (categories_.size() < kEnoughCategories && pool < candidates_.size());
    result_ = {{candidates_.data(), std::min<std::size_t>(pool, kNearestViews)},
               {categories_.data(), categories_.size()},
               static_cast<std::uint32_t>(candidates_.size())};
    for (const Neighbour& met : categories_) met_[categoryOf(met.view)] = false;
  }

  // The nearest `last` candidates stand first, in order, if the nearest `first` did.
  void sortCandidates(std::size_t first, std::size_t last) {
    const auto begin = candidates_.begin() + static_cast<std::ptrdiff_t>(first),
               middle = candidates_.begin() + static_cast<std::ptrdiff_t>(last);
    if (middle < candidates_.end()) std::nth_element(begin, middle, candidates_.end());
    std::sort(begin, middle);
  }

  // Views come nearest first: the first of a category is its nearest.
  void meet(const Neighbour& candidate) {
    const std::uint32_t category = categoryOf(candidate.view);
    if (category >= met_.size() || met_[category]) return;
    met_[category] = true;
    categories_.push_back(candidate);
  }

  // kNone for a view that leads nowhere, possible only in a damaged file.
  std::uint32_t categoryOf(std::uint32_t view) const {
    const std::uint32_t model = index_->modelOf(view);
    return model < index_->models().size ? index_->models()[model].category : kNone;
  }

  std::shared_ptr<const Index> index_;
  std::size_t least_lists_;
  std::vector<std::uint32_t> centroid_distances_, distances_;
  std::vector<Neighbour> buckets_;  // `view` is the bucket's number
  std::size_t sorted_ = 0;
  std::vector<Neighbour> candidates_, categories_;
  std::vector<bool> met_;  // by category
  Nearest result_;
};

}  // namespace

std::unique_ptr<Search> makeListSearch(std::shared_ptr<const Index> index, int lists) {
  return std::make_unique<ListSearch>(std::move(index), lists);
}

}  // namespace voxid
