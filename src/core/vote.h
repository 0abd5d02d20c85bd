// SPDX-License-Identifier: BSD-3-Clause
// How neighbours vote: shared by the ranking of categories and by what is known about its reliability.
#pragma once

#include <array>
#include <cstdint>

#include "voxid/core/index.h"
#include "voxid/core/search.h"

namespace voxid {

constexpr std::uint32_t kNoCategory = 0xffffffff;

// exp(-3 i / 256) in 1/2^30, by repeated multiplication with exp(-3 / 256) in 1/2^32; beyond 5 d1 (6e-6) zero.
constexpr int kWeightSteps = 256;
constexpr int kWeights = 4 * kWeightSteps + 1;
using Weights = std::array<std::uint32_t, kWeights>;

constexpr Weights makeWeights() {
  constexpr std::uint64_t kFactor = 4244929411;
  Weights weights{};
  std::uint64_t weight = std::uint64_t{1} << 30;
  for (std::uint32_t& entry : weights) {
    entry = static_cast<std::uint32_t>(weight);
    weight = weight * kFactor >> 32;
  }
  return weights;
}
constexpr Weights kWeightTable = makeWeights();

inline std::uint32_t weightOf(std::uint32_t distance, std::uint32_t nearest) {
  if (distance <= nearest) return kWeightTable[0];
  if (nearest == 0) return 0;
  const std::uint64_t step = std::uint64_t{distance - nearest} * kWeightSteps / nearest;
  return step < kWeights ? kWeightTable[step] : 0;
}

// A model's vote: exp(-4.5 (d / d1 - 1)), of its nearest view. Measured: doc/descriptor.md, section 7.
inline std::uint32_t voteOf(std::uint32_t distance, std::uint32_t nearest) {
  return weightOf(distance <= nearest ? nearest : nearest + 3 * (distance - nearest) / 2, nearest);
}

// kNoCategory for a view that leads nowhere, possible only in a damaged file.
inline std::uint32_t categoryOf(const Index& index, Neighbour found) {
  if (found.view >= index.viewCount()) return kNoCategory;
  const std::uint32_t model = index.modelOf(found.view);
  if (model >= index.models().size) return kNoCategory;
  const std::uint32_t category = index.models()[model].category;
  return category < index.categories().size ? category : kNoCategory;
}

}  // namespace voxid
