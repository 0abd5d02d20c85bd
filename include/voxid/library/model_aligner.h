// SPDX-License-Identifier: BSD-3-Clause
// What a search found, aligned with the object.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "voxid/core/search.h"
#include "voxid/geometry/aligned_choice.h"
#include "voxid/library/model_shelf.h"

namespace voxid {

/// A model that an object may be.
struct RankedModel {
  std::uint32_t model = 0;  ///< of the index
  std::uint32_t view = 0;   ///< its nearest view
  float cost = 0;           ///< see ChoiceParams; smaller is better
  Alignment alignment;      ///< `found` is false for those that were not refined
};

/// The models of the nearest views, nearest first, then those of the nearest categories; at most `most`.
std::vector<RankedModel> modelsOf(const Index& index, const Nearest& nearest, std::size_t most);

/// Aligns models of an index with objects. One object a thread.
class ModelAligner {
 public:
  static constexpr std::size_t kModels = 10;

  ModelAligner(std::shared_ptr<const Index> index, const std::string& models)
      : index_(std::move(index)), shelf_(index_, models) {}

  /// The models of `nearest`, ordered anew; those without a readable surface are left out. Fails if none has one.
  Result<std::vector<RankedModel>> rank(const ObservedObject& object, const Nearest& nearest);

  Aligner& aligner() { return aligner_; }
  ModelShelf& shelf() { return shelf_; }

 private:
  std::shared_ptr<const Index> index_;
  ModelShelf shelf_;
  Aligner aligner_;
};

}  // namespace voxid
