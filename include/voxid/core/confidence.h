// SPDX-License-Identifier: BSD-3-Clause
// How likely an answer is right, by what its neighbours say. Learnt by `voxid build` from the index's own views
// (voxid/library/confidence_learner.h; doc/unknown.md), kept in the index's section CONF, integers only.
#pragma once

#include <array>
#include <cstdint>

#include "voxid/core/index.h"
#include "voxid/core/search.h"

namespace voxid {

/// In this order, logarithms base 2 in 1/256 (between powers of two linear), shares in 1/1,024:
///   0 of the distance of the answer's nearest view;
///   1 the margin: of the nearest other category's distance over the answer's, negative if the vote went against the
///     nearest, at most four octaves either way;
///   2, 3 of the third's and the tenth nearest category's distance over the first's, at most four octaves;
///   4, 5 the answer's share of the vote of the ten nearest views, and of the twenty nearest;
///   6 different models of the answer among the twenty, each 64;
///   7 of the number of models that the answer's category has, at least one;
///   8 the product of 6 and 7, in 1/256.
/// Where fewer categories or views were met, the last of them counts.
using ConfidenceFeatures = std::array<std::int32_t, format::Confidence::kFeatures>;

/// What `nearest` (which is not empty) says about `category`, one that it met. `left_out_model`: as in the search; it
/// does not count among its category's models.
ConfidenceFeatures confidenceFeatures(const Index& index, const Nearest& nearest, std::uint32_t category,
                                      std::uint32_t left_out_model = Search::kNone);

/// The chance that the answer is right, 1 to 999.
std::uint16_t confidencePermille(const format::Confidence& confidence, const ConfidenceFeatures& features);

}  // namespace voxid
