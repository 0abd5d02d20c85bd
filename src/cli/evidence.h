// SPDX-License-Identifier: BSD-3-Clause
// What counts beside the codes: --evidence.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "object_pose.h"
#include "recogniser.h"
#include "voxid/geometry/longest_extent.h"
#include "voxid/library/aligned_naming.h"
#include "voxid/library/allowed_categories.h"

namespace voxid::cli {

/// A comma list of evidence, as an option, and what refines it.
struct EvidenceChoice {
  std::vector<std::string> names;
  ConfirmedSizes confirmed;  ///< of things whose category somebody confirmed

  void addTo(CLI::App& app);  ///< --evidence, --confirmed-sizes
  bool size() const;          ///< metric extents
  bool align() const;         ///< models, aligned
  Status check() const;       ///< BadUse for what does not go together

 private:
  const CLI::Option* confirmed_sizes_ = nullptr;
};

/// BadUse if the models of an index cannot be aligned, as `option` asks: it keeps no surfaces, and `models`, the folder
/// that it was made from, is not given.
Status checkSurfaces(const std::string& option, const Index& index, const std::string& models);

/// Names objects by their codes and by the chosen evidence. One object a thread.
class EvidenceRecogniser {
 public:
  /// `models`: the folder that the index was made from; empty: the index keeps the surfaces, or poses are never asked
  /// for, nor evidence that needs them.
  EvidenceRecogniser(std::shared_ptr<const Index> index, const SearchChoice& search, const EvidenceChoice& evidence,
                     const std::string& models);

  /// Only these are answers from now on.
  void restrictTo(AllowedCategories allowed) { allowed_ = std::move(allowed); }

  /// The nearest views, of categories that are allowed and may have the object's size. Null if there is nothing to
  /// compare. Belongs to the recogniser until its next call.
  const Nearest* nearest(const ObservedObject& object);

  /// The models to align with the object of the last nearest(). Reads them; what follows does not.
  Result<std::vector<SketchedModel>> candidates(const Nearest& nearest);
  AlignedNaming& naming() { return *naming_; }

  /// The answer by all evidence. `count` is zero if there is nothing to compare.
  Result<Answer> recognise(const ObservedObject& object, ClassifyMethod method, int min_score_permille);

  /// Where the category's best model stands, `object` being that of the last recognise(). Fails if no model can be
  /// read.
  Result<ObjectPose> pose(const ObservedObject& object, std::uint32_t category);

  const Index& index() const { return recogniser_.index(); }

 private:
  EvidenceChoice evidence_;
  Recogniser recogniser_;
  AllowedCategories allowed_, fitting_;
  std::optional<SizeTable> sizes_;
  LongestExtent extent_;
  std::optional<AlignedNaming> naming_;
  const Nearest* last_nearest_ = nullptr;
  std::vector<SketchedModel> last_candidates_;
};

}  // namespace voxid::cli
