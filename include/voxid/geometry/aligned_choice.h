// SPDX-License-Identifier: BSD-3-Clause
// Several models that an object may be, ordered anew by how well they align.
#pragma once

#include <vector>

#include "voxid/geometry/alignment.h"

namespace voxid {

struct ModelCandidate {
  const AlignableModel* model = nullptr;
  float code_ratio = 1;  ///< its nearest view's code distance over that of the nearest view of all; 1 or more
};

/// The cost of a candidate is code_ratio + misfit_weight * misfit: the code sees what kind of thing it is, the misfit
/// what the code's histograms average away. Wide, smooth models fit anything, so neither is enough.
struct ChoiceParams {
  int starts = 5;           ///< sketched of each model [1 to 64]
  int finished = 4;         ///< models that are refined at high resolution [1 to 64]
  int sketches_each = 2;    ///< of each of those [1 to starts]
  float misfit_weight = 3;  ///< [0 to 100]; doc/pose.md has the figures
};

struct ChosenModel {
  std::size_t candidate = 0;  ///< number
  float cost = 0;
  Alignment alignment;  ///< of models that were not refined, and of those that could not be: `found` is false
};

/// All candidates, least cost first; equal ones in their order. Those that were refined come with their alignment, and
/// their misfit at high resolution counts.
std::vector<ChosenModel> chooseByAlignment(Aligner& aligner, Span<const ModelCandidate> candidates,
                                           const ChoiceParams& params = {});

}  // namespace voxid
