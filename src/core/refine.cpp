// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/core/refine.h"

#include <algorithm>
#include <iterator>

#include "normaliser.h"
#include "vectorised.h"

namespace voxid {
namespace {

constexpr Neighbour kNotMet{Search::kNone, Search::kNone};

struct Products {
  std::int32_t query_moved, moved_moved, query_query;
};

// 2 code + mean lies where the code moved a third of the way does; at most 384, so that 96 squares stay below 2^24.
VOXID_VECTORISED Products productsOf(const std::int8_t* query, const std::int8_t* code, const std::int8_t* mean) {
  Products sums{};
  for (std::size_t i = 0; i < kCodeNumbers; ++i) {
    const auto q = static_cast<std::int16_t>(query[i]), moved = static_cast<std::int16_t>(2 * code[i] + mean[i]);
    sums.query_moved += q * moved;
    sums.moved_moved += moved * moved;
    sums.query_query += q * q;
  }
  return sums;
}

}  // namespace

// |q - L m / |m||^2 = |q|^2 + L^2 - 2 L q m / |m|, the root in 1/256.
std::uint32_t movedDistance(const std::uint8_t* query, const std::uint8_t* code, const std::int8_t* mean,
                            std::size_t code_bytes) {
  constexpr std::int64_t kLength = kCodeLength;
  const CodeNumbers q = numbersOf(query, code_bytes), c = numbersOf(code, code_bytes);
  const Products sums = productsOf(q.data(), c.data(), mean == nullptr ? c.data() : mean);
  const auto root_q8 = static_cast<std::int64_t>(squareRoot(static_cast<std::uint64_t>(sums.moved_moved) << 16));
  const std::int64_t along = root_q8 == 0 ? 0 : 2 * kLength * 256 * sums.query_moved / root_q8;
  return static_cast<std::uint32_t>(std::max<std::int64_t>(sums.query_query + kLength * kLength - along, 0));
}

void CodeMean::add(const std::uint8_t* code) {
  const CodeNumbers numbers = numbersOf(code, code_bytes_);
  for (std::size_t i = 0; i < kCodeNumbers; ++i) sums_[i] += numbers[i];
  ++codes_;
}

void CodeMean::write(std::int8_t* mean) const {
  for (const std::int64_t sum : sums_) {
    *mean++ = static_cast<std::int8_t>((2 * sum + (sum < 0 ? -codes_ : codes_)) / (2 * codes_));
  }
}

void CodeMean::clear() {
  sums_.fill(0);
  codes_ = 0;
}

Refiner::Refiner(std::size_t categories, std::size_t code_bytes) : code_bytes_(code_bytes), best_(categories, kNotMet) {
  views_.reserve(kNearestViews);
  categories_.reserve(categories);
}

void Refiner::clear() {
  views_.clear();
  categories_.clear();
  std::fill(best_.begin(), best_.end(), kNotMet);
}

void Refiner::addView(const std::uint8_t* query, const Moved& moved) {
  if (moved.category >= best_.size()) return;
  views_.push_back({moved.view, movedDistance(query, moved.code, moved.mean, code_bytes_)});
  best_[moved.category] = std::min(best_[moved.category], views_.back());
}

// The nearest of a category that is among the nearest of all has been measured.
void Refiner::addCategory(const std::uint8_t* query, const Moved& moved) {
  if (moved.category >= best_.size() || best_[moved.category].view != Search::kNone) return;
  best_[moved.category] = {moved.view, movedDistance(query, moved.code, moved.mean, code_bytes_)};
}

const Nearest& Refiner::sorted(std::uint32_t scanned) {
  std::sort(views_.begin(), views_.end());
  std::copy_if(best_.begin(), best_.end(), std::back_inserter(categories_),
               [](const Neighbour& best) { return best.view != Search::kNone; });
  std::sort(categories_.begin(), categories_.end());
  result_ = {{views_.data(), views_.size()}, {categories_.data(), categories_.size()}, scanned};
  return result_;
}

}  // namespace voxid
