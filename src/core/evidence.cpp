// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/core/evidence.h"

#include <algorithm>
#include <numeric>

#include "vote.h"

namespace voxid {
namespace {

constexpr std::uint64_t kOne = 1 << 16;

// 2^-x for x from 0 to below 1, in 1/2^32 so that a millisecond of the longest half-life counts: a parabola through
// both ends, within 0.3 %.
std::uint64_t halved(std::uint64_t x) {
  constexpr std::uint64_t kWhole = std::uint64_t{1} << 32;
  return kWhole - (44066 * x >> 16) + (11298 * (x * x >> 32) >> 16);
}

// The factor is at most 1, in 1/2^32. Sums stay below 2^16 x 2^23 x a million frames' weight: their halves are
// multiplied.
std::uint64_t times(std::uint64_t sum, std::uint64_t factor) {
  return (sum >> 32) * factor + ((sum & 0xffffffff) * factor >> 32);
}

}  // namespace

Evidence::Evidence(std::size_t categories) : categories_(categories), order_(categories) {}

void Evidence::clear() {
  std::fill(categories_.begin(), categories_.end(), Entry{});
  weight_ = 0;
  first_ = Search::kNone;
  frames_ = 0;
}

void Evidence::forget(std::int64_t elapsed_ms, std::int64_t half_life_ms) {
  constexpr std::int64_t kMostHalvings = 15;
  if (half_life_ms <= 0 || elapsed_ms / half_life_ms > kMostHalvings) return clear();
  const auto rest =
      (static_cast<std::uint64_t>(elapsed_ms % half_life_ms) << 32) / static_cast<std::uint64_t>(half_life_ms);
  const std::uint64_t factor = halved(rest) >> (elapsed_ms / half_life_ms);
  for (Entry& entry : categories_) {
    entry.distances = times(entry.distances, factor);
    entry.scores = times(entry.scores, factor);
  }
  weight_ = times(weight_, factor);
}

void Evidence::add(const Index& index, const Nearest& nearest, const Answer& answer) {
  if (nearest.categories.empty() || answer.count == 0) return;
  const std::uint64_t farthest = nearest.categories[nearest.categories.size - 1].distance;
  for (Entry& entry : categories_) entry.distances += farthest * kOne;
  for (const Neighbour& met : nearest.categories) {
    const std::uint32_t category = categoryOf(index, met);
    if (category >= categories_.size()) continue;
    categories_[category].distances -= (farthest - met.distance) * kOne;
  }
  see(index, nearest);
  for (int i = 0; i < answer.count; ++i) {
    const Alternative& alternative = answer.alternatives[static_cast<std::size_t>(i)];
    if (alternative.category < categories_.size())
      categories_[alternative.category].scores += alternative.score_permille * kOne;
  }
  weight_ += kOne;
}

void Evidence::see(const Index& index, const Nearest& nearest) {
  if (nearest.categories.empty()) return;
  ++frames_;
  farthest_ = nearest.categories[nearest.categories.size - 1].distance;
  for (const Neighbour& met : nearest.categories) {
    const std::uint32_t category = categoryOf(index, met);
    if (category >= categories_.size()) continue;
    categories_[category].last = met;
    categories_[category].frame = frames_;
  }
}

bool Evidence::closer(std::uint32_t a, std::uint32_t b) const {
  const std::uint64_t first = categories_[a].distances, second = categories_[b].distances;
  return first != second ? first < second : a < b;
}

// The first of the last answer stays in front of what is not clearly better.
void Evidence::hold(std::uint32_t parts) {
  if (first_ == Search::kNone || parts == 0 || order_[0] == first_) return;
  const std::uint64_t own = categories_[first_].distances, best = categories_[order_[0]].distances;
  if (best < own - own / parts) return;
  const auto place = std::find(order_.begin(), order_.end(), first_);
  std::rotate(order_.begin(), place, place + 1);
}

Answer Evidence::answer(const Index& index, int min_score_permille, int hold_parts) {
  Answer answer;
  if (weight_ == 0 || categories_.empty()) return answer;
  std::iota(order_.begin(), order_.end(), 0u);
  const std::size_t count = std::min<std::size_t>(order_.size(), Answer::kMaxAlternatives);
  std::partial_sort(order_.begin(), order_.begin() + static_cast<std::ptrdiff_t>(count), order_.end(),
                    [this](std::uint32_t a, std::uint32_t b) { return closer(a, b); });
  hold(static_cast<std::uint32_t>(std::max(hold_parts, 0)));
  first_ = order_[0];
  std::uint64_t before = 1000;
  for (std::size_t i = 0; i < count; ++i) {
    const Entry& entry = categories_[order_[i]];
    if (categoryOf(index, entry.last) != order_[i]) continue;  // never met
    before = std::min(before, entry.scores / weight_);
    answer.alternatives[static_cast<std::size_t>(answer.count++)] = {order_[i], entry.last.view, entry.last.distance,
                                                                     static_cast<std::uint16_t>(before)};
  }
  if (answer.count == 0) return answer;
  answer.score_permille = answer.alternatives[0].score_permille;
  answer.known = answer.score_permille >= min_score_permille;
  const std::uint64_t d1 = categories_[order_[0]].distances, d2 = count > 1 ? categories_[order_[1]].distances : 0;
  answer.margin_permille = count < 2 ? 1000 : d2 <= d1 ? 0 : static_cast<std::uint32_t>((d2 - d1) * 1000 / d2);
  return answer;
}

std::uint32_t Evidence::meanDistance() const {
  if (first_ == Search::kNone || weight_ == 0) return 0;
  return static_cast<std::uint32_t>(categories_[first_].distances / weight_);
}

std::uint32_t Evidence::lastDistance() const {
  if (first_ == Search::kNone) return 0;
  const Entry& first = categories_[first_];
  return first.frame == frames_ ? first.last.distance : farthest_;
}

}  // namespace voxid
