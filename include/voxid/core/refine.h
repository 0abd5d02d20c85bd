// SPDX-License-Identifier: BSD-3-Clause
// What a view's category adds to its code, for profile "default".
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "voxid/core/code.h"
#include "voxid/core/search.h"

namespace voxid {

/// Squared distance, 0 to 4 kCodeLength^2 = 518,400, from a query to `code` moved a third of the way to `mean`, its
/// category's kCodeNumbers, and brought to length again (shrinkage; the weight is measured in doc/descriptor.md,
/// section 7). `mean` null: to the code itself, brought to length.
std::uint32_t movedDistance(const std::uint8_t* query, const std::uint8_t* code, const std::int8_t* mean,
                            std::size_t code_bytes);

/// The mean of the numbers of some codes, to be added one by one.
class CodeMean {
 public:
  explicit CodeMean(std::size_t code_bytes) : code_bytes_(code_bytes) {}
  void add(const std::uint8_t* code);
  bool empty() const { return codes_ == 0; }
  /// kCodeNumbers of them, rounded to nearest, halves away from zero. Some code was added.
  void write(std::int8_t* mean) const;
  void clear();

 private:
  std::size_t code_bytes_;
  std::array<std::int64_t, kCodeNumbers> sums_{};
  std::int64_t codes_ = 0;
};

/// A view to be measured anew.
struct Moved {
  std::uint32_t view = 0, category = 0;
  const std::uint8_t* code = nullptr;
  const std::int8_t* mean = nullptr;  ///< null: none
};

/// Measures what a search found by movedDistance and sorts it anew. Moving all codes of an index when it is made would
/// do the same, but then a model that is added would change the codes of others.
class Refiner {
 public:
  Refiner(std::size_t categories, std::size_t code_bytes);

  /// moved(view) says what a view is; one whose category is none of the `categories` is left out. The result belongs to
  /// the refiner until its next call. No allocation.
  template <typename MovedOf>
  const Nearest& refine(const std::uint8_t* query, const Nearest& found, MovedOf moved) {
    clear();
    for (const Neighbour& view : found.views) addView(query, moved(view.view));
    for (const Neighbour& view : found.categories) addCategory(query, moved(view.view));
    return sorted(found.scanned);
  }

 private:
  void clear();
  void addView(const std::uint8_t* query, const Moved& moved);
  void addCategory(const std::uint8_t* query, const Moved& moved);
  const Nearest& sorted(std::uint32_t scanned);

  std::size_t code_bytes_;
  std::vector<Neighbour> views_, categories_;
  std::vector<Neighbour> best_;  // by category
  Nearest result_;
};

}  // namespace voxid
