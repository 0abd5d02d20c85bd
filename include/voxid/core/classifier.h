// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>

#include "voxid/core/search.h"

namespace voxid {

enum class ClassifyMethod : std::uint8_t {
  OneNn,  ///< the category of the nearest view (the paper's)
  Vote,   ///< the models of the nearest views, each by its nearest with exp(-4.5 (d / d1 - 1)), d1 the nearest of all
};

/// One category that the object may belong to.
struct Alternative {
  std::uint32_t category = 0;
  std::uint32_t view = 0;            ///< its nearest view
  std::uint32_t distance = 0;        ///< of that view
  std::uint16_t score_permille = 0;  ///< see Answer; falls from rank to rank, all together at most 1000
};

/// What an object is. `count` is zero only if nothing could be compared.
struct Answer {
  static constexpr int kMaxAlternatives = 10;
  std::array<Alternative, kMaxAlternatives> alternatives{};  ///< best first; [0] is the answer
  int count = 0;
  std::uint32_t margin_permille = 0;  ///< 1000 (d2 - d1) / d2 of the two nearest categories; 1000 if there is one only
  std::uint16_t score_permille = 0;   ///< chance that the first is right (confidence.h). In an index without section
                                      ///< CONF its calibration at this margin, at margin 0 if the vote went against
                                      ///< the nearest category
  bool known = false;                 ///< score_permille >= min_score_permille: below, the label is to be left empty
};

/// Ranks categories by what a search found: those that were voted for by weight, then the others by distance. What the
/// first one's score leaves of 1000 is shared among the others by weight. Integers only; equal weights are ordered by
/// distance, equal distances by category number. Allocates nothing.
Answer classify(const Index& index, const Nearest& nearest, ClassifyMethod method, int min_score_permille);

}  // namespace voxid
