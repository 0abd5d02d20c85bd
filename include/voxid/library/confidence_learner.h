// SPDX-License-Identifier: BSD-3-Clause
// How far the answers of an index may be trusted, learnt from the index alone: no query, no mesh (doc/unknown.md).
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "voxid/core/index.h"
#include "voxid/library/index_assembler.h"

namespace voxid {

/// Asks for views of the index's own models, each with its own model left out, and fits the chance that the vote names
/// it rightly. Of categories with three or more models, about kConfidenceQueries views, fewer where the index is so
/// large that comparing would take more than minutes. Depends on the index's content only. Empty if fewer than
/// kConfidenceModels models or 200 views can be asked for: a fit to so few would say more about them than about the
/// next object.
std::optional<format::Confidence> learnConfidence(const std::shared_ptr<const Index>& index);
constexpr std::uint32_t kConfidenceQueries = 8000, kConfidenceModels = 30;

/// What an index teaches about itself.
struct Learnt {
  format::Calibration calibration{};
  std::optional<format::Confidence> confidence;
};
using Calibrate = std::function<format::Calibration(const std::shared_ptr<const Index>& index)>;

/// Writes the whole to `path` with what it teaches: first to `draft`, a file that may be written to meanwhile and is
/// removed, to be asked.
Result<Learnt> writeWithConfidence(IndexAssembler& whole, const Calibrate& calibrate, const std::string& draft,
                                   const std::string& path);

}  // namespace voxid
