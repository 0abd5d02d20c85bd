// SPDX-License-Identifier: BSD-3-Clause
// An object of a depth image is compared with an index.
#pragma once

#include <CLI/CLI.hpp>
#include <array>
#include <memory>
#include <string>
#include <vector>

#include "scene_json.h"
#include "voxid/core/classifier.h"
#include "voxid/core/classify_params.h"
#include "voxid/core/encoder.h"
#include "voxid/library/allowed_categories.h"

namespace voxid::cli {

/// How views are compared, as options.
struct SearchChoice {
  SearchParams params;  // every view: at a desk nobody waits for the next frame

  void addTo(CLI::App& app);  ///< --exact, --radius, --lists
  /// BadUse for a way of searching that the index's profile does not have.
  Status check(const Index& index) const;

 private:
  std::array<const CLI::Option*, 2> quick_{};  // --radius, --lists
};

/// Describes and searches; one object a thread. Memory is taken at construction.
class Recogniser {
 public:
  Recogniser(std::shared_ptr<const Index> index, const SearchChoice& choice);

  /// The nearest views of the object that `pixels` (row * width + column) show, of the categories allowed. Null if
  /// there is nothing to compare: no pixel with depth, or all points in one place. Belongs to the recogniser until its
  /// next call.
  const Nearest* nearest(const DepthView& depth, Span<const std::uint32_t> pixels,
                         const AllowedCategories& allowed = {});

  /// `nearest`, ranked. `count` is zero if there is nothing to compare.
  Answer recognise(const DepthView& depth, Span<const std::uint32_t> pixels, ClassifyMethod method,
                   int min_score_permille);

  /// The code of the object of the last call.
  const std::uint8_t* code() const { return code_.data(); }
  const Index& index() const { return *index_; }

 private:
  std::shared_ptr<const Index> index_;
  std::unique_ptr<Encoder> encoder_;
  std::vector<std::uint8_t> code_;
  std::unique_ptr<Search> search_;
};

/// All pixels with depth, ascending: the object of an image that shows nothing else.
std::vector<std::uint32_t> setPixels(const DepthView& depth);

/// Adds label (empty if not known), score, alternatives (label, score, distance; best first), coarse (the synset that
/// can be told, empty if none) and its coarse_score, model, view (number of its direction, 0 to 79) to `object`; model
/// is empty and view null if nothing was compared.
void addAnswer(const Index& index, const Answer& answer, Json& object);

/// "mug 87 %", or "? (mug 12 %)" if the score is too low, "?" if nothing was compared.
std::string captionOf(const Index& index, const Answer& answer);

/// One line, safe for any bytes in file names.
std::string lineOf(const Json& json);

}  // namespace voxid::cli
