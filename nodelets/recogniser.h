// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "answer_scope.h"
#include "voxid/core/classifier.h"
#include "voxid/core/classify_params.h"
#include "voxid/core/encoder.h"
#include "voxid/core/search.h"

namespace voxid {

/// Descriptor, search and classifier of one index in a row.
class Recogniser {
 public:
  /// `scope`: of the index; null: objects may be of any category.
  explicit Recogniser(std::shared_ptr<const Index> index, std::shared_ptr<const AnswerScope> scope = nullptr);

  /// What the pixels (row * width + column) show; `count` is zero if they have no extent.
  Answer recognise(const DepthView& depth, Span<const std::uint32_t> pixels, const ClassifyParams& params);
  /// The views nearest to them, until the next call; null if they have no extent. `only`: a category of the index that
  /// they are known to be, whatever the scope says.
  const Nearest* nearest(const DepthView& depth, Span<const std::uint32_t> pixels, const ClassifyParams& params,
                         std::optional<std::uint32_t> only = {});
  const std::vector<std::uint8_t>& code() const { return code_; }  ///< of the pixels that were asked about last
  const Index& index() const { return *index_; }

 private:
  Search& searchFor(const ClassifyParams& params);

  std::shared_ptr<const Index> index_;
  std::shared_ptr<const AnswerScope> scope_;
  AnswerScope::Workspace workspace_;
  AllowedCategories only_;
  std::unique_ptr<Encoder> encoder_;
  std::vector<std::uint8_t> code_;
  std::unique_ptr<Search> search_;
  SearchParams made_for_;
};

}  // namespace voxid
