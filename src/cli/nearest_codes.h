// SPDX-License-Identifier: BSD-3-Clause
// Exhaustive search over views by any descriptor, among all categories or some.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "compare_codes.h"
#include "voxid/core/refine.h"
#include "voxid/core/search.h"
#include "voxid/library/allowed_categories.h"

namespace voxid::cli {

class CodeSearch {
 public:
  /// The code of the i-th of `views`; null if the descriptor has none for it.
  using CodeAt = std::function<const std::uint8_t*(std::size_t i)>;

  /// `index` and `code` outlive the search. `views` are numbers of the index, ascending.
  CodeSearch(const Index& index, ViewCode& code, std::vector<std::uint32_t> views, CodeAt code_at);

  /// As makeSearch finds them, distances as `code` counts them or, where it is refined, by movedDistance. Null if there
  /// is no answer for these pixels. Belongs to the search until its next call.
  const Nearest* find(const DepthView& depth, Span<const std::uint32_t> pixels, const AllowedCategories& allowed = {});

  const ViewCode& code() const { return code_; }
  /// The code of the pixels of the last find.
  const std::uint8_t* query() const { return query_.data(); }

 private:
  std::uint32_t categoryOf(std::uint32_t view) const { return index_.models()[index_.modelOf(view)].category; }
  const std::uint8_t* codeOf(std::uint32_t view) const;
  void learnMeans();
  void compareAll(const AllowedCategories& allowed);
  const Nearest& sorted();

  const Index& index_;
  ViewCode& code_;
  std::vector<std::uint32_t> views_;
  CodeAt code_at_;
  std::vector<std::uint8_t> query_;
  std::vector<Neighbour> found_, categories_;
  Nearest result_;
  std::optional<Refiner> refiner_;               // of a code that is refined
  std::vector<std::vector<std::int8_t>> means_;  // of these views, by category; empty: none
};

}  // namespace voxid::cli
