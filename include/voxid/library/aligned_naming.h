// SPDX-License-Identifier: BSD-3-Clause
// Alignment as evidence: what an object is, by codes and by how well models of each category fit it.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "voxid/core/classifier.h"
#include "voxid/core/encoder.h"
#include "voxid/core/search.h"
#include "voxid/geometry/alignment.h"
#include "voxid/library/model_shelf.h"

namespace voxid {

/// A model that an object may be, and where it may stand.
struct SketchedModel {
  std::uint32_t model = 0;     ///< of the index
  std::uint32_t view = 0;      ///< its nearest view
  std::uint32_t distance = 0;  ///< of that view, as in Nearest
  std::shared_ptr<const ShelvedModel> shelved;
  std::vector<Sketch> sketches;  ///< best first; empty before sketch(), and if nothing could be compared
  std::uint32_t drawn_distance = Search::kNone;  ///< of the code of what the camera would see of it in its best pose,
                                                 ///< as `distance`; kNone: not drawn

  float misfit() const { return sketches.empty() ? 1 : sketches.front().misfit; }  ///< see Alignment
};

/// What speaks for a category: -distance ln(d / d1) - misfit ln(misfit) - drawn ln(e / d1) + models ln(n), log odds; d
/// its nearest view's code distance (squared in profile "default"), d1 that of all, the misfit of the model that fits
/// best, e the least drawn_distance, n the models that the index has of it. How they were fitted: doc/pose.md.
struct NamingWeights {
  double distance = 5;
  double misfit = 6;
  double drawn = 1;
  double models = 0.15;
  double among = 0.85;  ///< what the compared categories' chances add up to: their mean is then the share of right ones
};

/// One object a thread.
class AlignedNaming {
 public:
  static constexpr std::size_t kCategories = 8, kModelsEach = 6;  ///< that are compared
  static constexpr std::size_t kDrawnEach = 2;                    ///< of them, those that fit best, are drawn

  /// `models`: as in ModelShelf.
  AlignedNaming(std::shared_ptr<const Index> index, const std::string& models)
      : index_(std::move(index)),
        shelf_(index_, models),
        encoder_(makeEncoder(index_->profile())),
        query_(index_->profile().codeBytes()),
        drawn_code_(query_.size()) {}

  /// Of each of the kCategories nearest categories the kModelsEach models nearest the code; those without a readable
  /// surface are left out. Fails if none has one. Reads what the shelf does not hold yet.
  Result<std::vector<SketchedModel>> candidates(const std::uint8_t* code, const Nearest& nearest);

  /// Fills in how the candidates of the last candidates() fit. 0.1 to 0.2 s.
  void sketch(const ObservedObject& object, std::vector<SketchedModel>& candidates);

  /// The categories of the candidates by NamingWeights, each with the view of its best model, and then those that were
  /// not compared by distance. score_permille is the chance that the category is right.
  Answer name(const Nearest& nearest, const std::vector<SketchedModel>& candidates, int min_score_permille) const;

  /// The candidate of the category that fits best, and its pose at high resolution. Of the object of the last sketch().
  struct Posed {
    const SketchedModel* model = nullptr;  ///< null: no candidate of this category
    Alignment alignment;
  };
  Posed pose(const std::vector<SketchedModel>& candidates, std::uint32_t category);

  const Index& index() const { return *index_; }

 private:
  void draw(SketchedModel& candidate);

  std::shared_ptr<const Index> index_;
  ModelShelf shelf_;
  Aligner aligner_;
  std::unique_ptr<Encoder> encoder_;
  std::vector<std::uint8_t> query_, drawn_code_;
};

}  // namespace voxid
