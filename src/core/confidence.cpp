// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/core/confidence.h"

#include <algorithm>
#include <cstdlib>

#include "vote.h"

namespace voxid {
namespace {

constexpr std::int32_t kOctave = 256, kMostOctaves = 4, kWhole = 1024, kPerModel = 64;
constexpr std::size_t kThird = 2, kTenth = 9;
constexpr std::size_t kVoters = 10, kAgreeing = 20;  // nearest views that are looked at

// log2(x + 1) in 1/256; between powers of two linear.
std::int32_t logOf(std::uint32_t x) {
  std::uint64_t mantissa = std::uint64_t{x} + 1;
  std::int32_t octaves = 0;
  while (mantissa >> (octaves + 1) != 0) ++octaves;
  return octaves * kOctave + static_cast<std::int32_t>((mantissa << 8 >> octaves) - 256);
}

std::int32_t logRatio(std::uint32_t a, std::uint32_t b) {
  constexpr std::int32_t kMost = kMostOctaves * kOctave;
  return std::clamp(logOf(a) - logOf(b), -kMost, kMost);
}

// How much farther the place-th category is than the first; alone, it is as far as can be.
std::int32_t spreadTo(Span<const Neighbour> categories, std::size_t place) {
  if (categories.size < 2) return kMostOctaves * kOctave;
  return logRatio(categories[std::min(place, categories.size - 1)].distance, categories[0].distance);
}

// The nearest view of the category that is looked for, and that of the nearest other one.
struct Rivals {
  std::uint32_t own = 0, other = 0;
  bool has_other = false;
};

Rivals rivalsOf(const Index& index, Span<const Neighbour> categories, std::uint32_t category) {
  Rivals rivals;
  bool has_own = false;
  for (std::size_t i = 0; i < categories.size && !(has_own && rivals.has_other); ++i) {
    const bool is_own = categoryOf(index, categories[i]) == category;
    bool& known = is_own ? has_own : rivals.has_other;
    if (!known) (is_own ? rivals.own : rivals.other) = categories[i].distance;
    known = true;
  }
  return rivals;
}

// Of the votes of the `voters` nearest views.
std::int32_t shareOf(const Index& index, Span<const Neighbour> views, std::uint32_t category, std::size_t voters) {
  std::uint64_t own = 0, all = 0;
  for (std::size_t i = 0; i < std::min(voters, views.size); ++i) {
    const std::uint64_t weight = weightOf(views[i].distance, views[0].distance);
    all += weight;
    if (categoryOf(index, views[i]) == category) own += weight;
  }
  return all == 0 ? 0 : static_cast<std::int32_t>(own * kWhole / all);
}

std::int32_t modelsAmong(const Index& index, Span<const Neighbour> views, std::uint32_t category) {
  std::array<std::uint32_t, kAgreeing> met{};
  auto* end = met.begin();
  for (std::size_t i = 0; i < std::min(views.size, kAgreeing); ++i) {
    if (categoryOf(index, views[i]) != category) continue;
    const std::uint32_t model = index.modelOf(views[i].view);
    if (std::find(met.begin(), end, model) == end) *end++ = model;
  }
  return static_cast<std::int32_t>(end - met.begin());
}

std::uint32_t modelsOf(const Index& index, std::uint32_t category, std::uint32_t left_out_model) {
  if (category >= index.categories().size) return 0;
  const bool less = left_out_model < index.models().size && index.models()[left_out_model].category == category;
  return index.categories()[category].models - (less ? 1 : 0);
}

// 1 / (1 + exp(-i / 256)) in 1/1,000 for i from 0 on, by repeated multiplication with exp(-1 / 256) in 1/2^32.
constexpr int kStepsPerLogit = 256, kMostLogits = 7;
using Logistic = std::array<std::uint16_t, kMostLogits * kStepsPerLogit + 1>;

constexpr Logistic makeLogistic() {
  constexpr std::uint64_t kFactor = 4278222805, kOne = std::uint64_t{1} << 30;
  Logistic table{};
  std::uint64_t falling = kOne;
  for (std::uint16_t& entry : table) {
    entry = static_cast<std::uint16_t>((1000 * kOne + (kOne + falling) / 2) / (kOne + falling));
    falling = falling * kFactor >> 32;
  }
  return table;
}
constexpr Logistic kLogistic = makeLogistic();

}  // namespace

ConfidenceFeatures confidenceFeatures(const Index& index, const Nearest& nearest, std::uint32_t category,
                                      std::uint32_t left_out_model) {
  const Rivals rivals = rivalsOf(index, nearest.categories, category);
  const std::int32_t agreeing = modelsAmong(index, nearest.views, category);
  const std::int32_t size = logOf(std::max(modelsOf(index, category, left_out_model), 1u) - 1);
  return {logOf(rivals.own),
          rivals.has_other ? logRatio(rivals.other, rivals.own) : kMostOctaves * kOctave,
          spreadTo(nearest.categories, kThird),
          spreadTo(nearest.categories, kTenth),
          shareOf(index, nearest.views, category, kVoters),
          shareOf(index, nearest.views, category, kAgreeing),
          agreeing * kPerModel,
          size,
          agreeing * kPerModel * size / 256};
}

// Weights are below 2^31 and features below 2^18 in size: nine products sum to less than 2^53.
std::uint16_t confidencePermille(const format::Confidence& confidence, const ConfidenceFeatures& features) {
  std::int64_t logit = confidence.bias;
  for (std::size_t i = 0; i < features.size(); ++i) logit += std::int64_t{confidence.weights[i]} * features[i];
  constexpr std::int64_t kStep = format::Confidence::kUnit / kStepsPerLogit;
  const std::int64_t steps = std::min<std::int64_t>(std::abs(logit) / kStep, kLogistic.size() - 1);
  const std::uint16_t permille = kLogistic[static_cast<std::size_t>(steps)];
  return static_cast<std::uint16_t>(logit >= 0 ? permille : 1000 - permille);
}

}  // namespace voxid
