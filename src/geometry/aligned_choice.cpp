// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/geometry/aligned_choice.h"

#include <algorithm>

namespace voxid {
namespace {

void sortByCost(std::vector<ChosenModel>& chosen, std::size_t first, std::size_t last) {
  std::stable_sort(chosen.begin() + static_cast<std::ptrdiff_t>(first),
                   chosen.begin() + static_cast<std::ptrdiff_t>(last),
                   [](const ChosenModel& a, const ChosenModel& b) { return a.cost < b.cost; });
}

float costOf(const ModelCandidate& candidate, float misfit, const ChoiceParams& params) {
  return candidate.code_ratio + params.misfit_weight * misfit;
}

}  // namespace

std::vector<ChosenModel> chooseByAlignment(Aligner& aligner, Span<const ModelCandidate> candidates,
                                           const ChoiceParams& params) {
  std::vector<std::vector<Sketch>> sketches(candidates.size);
  std::vector<ChosenModel> chosen(candidates.size);
  for (std::size_t i = 0; i < candidates.size; ++i) {
    sketches[i] = aligner.sketch(*candidates[i].model, params.starts);
    chosen[i].candidate = i;
    chosen[i].cost = costOf(candidates[i], sketches[i].empty() ? 1 : sketches[i][0].misfit, params);
  }
  sortByCost(chosen, 0, chosen.size());
  const std::size_t refined = std::min(chosen.size(), static_cast<std::size_t>(params.finished));
  for (std::size_t i = 0; i < refined; ++i) {
    ChosenModel& c = chosen[i];
    const std::size_t most = std::min(sketches[c.candidate].size(), static_cast<std::size_t>(params.sketches_each));
    c.alignment = aligner.finish(*candidates[c.candidate].model, {sketches[c.candidate].data(), most});
    c.cost = costOf(candidates[c.candidate], c.alignment.found ? c.alignment.misfit : 1, params);
  }
  sortByCost(chosen, 0, refined);
  return chosen;
}

}  // namespace voxid
