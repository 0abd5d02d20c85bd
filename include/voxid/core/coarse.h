// SPDX-License-Identifier: BSD-3-Clause
// What can be said of an object where its category cannot: "a container".
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "voxid/core/classifier.h"

namespace voxid {

/// A synset of WordNet that the object is likely to be one of.
struct CoarseAnswer {
  std::string_view synset;  ///< in NLTK's form ("container.n.01"), of the index's texts; empty: nothing can be said
  std::uint16_t score_permille = 0;  ///< the alternatives' scores that speak for it
  bool is_category = false;          ///< it is the first alternative's own synset
};

constexpr int kLevelsThatSayNothing = 6, kCoarseScorePermille = 700;  ///< chosen in doc/unknown.md

/// The lowest common hypernym of enough of the ranked categories: of all synsets that hold categories whose scores sum
/// to at least `min_score_permille` (501 to 1000, so that they lie above one another; clamped) the lowest one. The
/// highest levels of WordNet (entity to artifact and instrumentality, kLevelsThatSayNothing of them) are no answer.
/// Empty in an index without hypernyms. Pure, integers only, allocates nothing.
CoarseAnswer coarseAnswer(const Index& index, const Answer& answer, int min_score_permille = kCoarseScorePermille);

/// "drinking vessel" of "drinking_vessel.n.01"; empty of an empty one.
std::string wordsOf(std::string_view synset);

}  // namespace voxid
