// SPDX-License-Identifier: BSD-3-Clause
#include "nearest_codes.h"

#include <algorithm>
#include <iterator>

namespace voxid::cli {

CodeSearch::CodeSearch(const Index& index, ViewCode& code, std::vector<std::uint32_t> views, CodeAt code_at)
    : index_(index), code_(code), views_(std::move(views)), code_at_(std::move(code_at)), query_(code.bytes) {
  found_.reserve(views_.size());
  if (!code_.refined) return;
  refiner_.emplace(index_.categories().size, code_.bytes);
  learnMeans();
}

void CodeSearch::learnMeans() {
  std::vector<CodeMean> means(index_.categories().size, CodeMean(code_.bytes));
  for (std::size_t i = 0; i < views_.size(); ++i) {
    if (const std::uint8_t* const code = code_at_(i)) means[categoryOf(views_[i])].add(code);
  }
  means_.resize(means.size());
  for (std::size_t i = 0; i < means.size(); ++i) {
    if (means[i].empty()) continue;
    means_[i].resize(kCodeNumbers);
    means[i].write(means_[i].data());
  }
}

const std::uint8_t* CodeSearch::codeOf(std::uint32_t view) const {
  return code_at_(static_cast<std::size_t>(std::lower_bound(views_.begin(), views_.end(), view) - views_.begin()));
}

const Nearest* CodeSearch::find(const DepthView& depth, Span<const std::uint32_t> pixels,
                                const AllowedCategories& allowed) {
  if (!code_.describe(depth, pixels, query_.data())) return nullptr;
  compareAll(allowed);
  const Nearest& found = sorted();
  if (!refiner_) return &found;
  return &refiner_->refine(query_.data(), found, [this](std::uint32_t view) {
    const std::uint32_t category = categoryOf(view);
    return Moved{view, category, codeOf(view), means_[category].data()};
  });
}

void CodeSearch::compareAll(const AllowedCategories& allowed) {
  found_.clear();
  for (std::size_t i = 0; i < views_.size(); ++i) {
    if (!allowed.empty() && allowed[categoryOf(views_[i])] == 0) continue;
    const std::uint8_t* const code = code_at_(i);
    if (code != nullptr) found_.push_back({views_[i], code_.distance(query_.data(), code)});
  }
}

const Nearest& CodeSearch::sorted() {
  std::vector<Neighbour> best(index_.categories().size, Neighbour{Search::kNone, Search::kNone});
  for (const Neighbour& candidate : found_) {
    Neighbour& nearest = best[categoryOf(candidate.view)];
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
