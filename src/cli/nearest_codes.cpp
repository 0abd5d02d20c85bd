// SPDX-License-Identifier: BSD-3-Clause
#include "nearest_codes.h"

#include <algorithm>

namespace voxid::cli {

NearestCodes::NearestCodes(const Index& index) : index_(index) { found_.reserve(index.views().size); }

void NearestCodes::clear() { found_.clear(); }

void NearestCodes::add(std::uint32_t view, std::uint32_t distance) { found_.push_back({view, distance}); }

const Nearest& NearestCodes::result() {
  std::vector<Neighbour> best(index_.categories().size, Neighbour{Search::kNone, Search::kNone});
  for (const Neighbour& candidate : found_) {
    Neighbour& nearest = best[index_.models()[index_.views()[candidate.view].model].category];
    nearest = std::min(nearest, candidate);
  }
  categories_.clear();
  std::copy_if(best.begin(), best.end(), std::back_inserter(categories_),
               [](const Neighbour& n) { return n.view != Search::kNone; });
  std::sort(categories_.begin(), categories_.end());
  const std::size_t kept = std::min<std::size_t>(kNearestViews, found_.size());
  std::partial_sort(found_.begin(), found_.begin() + static_cast<std::ptrdiff_t>(kept), found_.end());
  result_ = {
      {found_.data(), kept}, {categories_.data(), categories_.size()}, static_cast<std::uint32_t>(found_.size())};
  return result_;
}

}  // namespace voxid::cli
