// SPDX-License-Identifier: BSD-3-Clause
// What several frames say about one object.
#pragma once

#include <cstdint>
#include <vector>

#include "voxid/core/classifier.h"
#include "voxid/core/search.h"

namespace voxid {

/// Each category's least distance, summed over the frames in which the object was seen: the category with the least sum
/// is the answer. What lies further back counts less. Integers only; memory is taken at construction.
class Evidence {
 public:
  explicit Evidence(std::size_t categories);

  void clear();

  /// `elapsed_ms` later; what was seen `half_life_ms` ago counts half. Both are not negative; half_life_ms 0 forgets
  /// all.
  void forget(std::int64_t elapsed_ms, std::int64_t half_life_ms);

  /// One frame: what the search found, and what it would be called by that alone. A category that was not met counts as
  /// far as the farthest that was. Nothing is added if `nearest` is empty.
  void add(const Index& index, const Nearest& nearest, const Answer& answer);

  /// One frame that says where its categories lie and adds nothing to the sums.
  void see(const Index& index, const Nearest& nearest);

  /// What all frames say: categories by their sums, with the view of the last frame. The first gives way to another
  /// only if that is better by more than 1/`hold` of its sum (0: by anything). score_permille is the mean over the
  /// frames of the score that each gave the category. `count` is zero if no frame was added.
  Answer answer(const Index& index, int min_score_permille, int hold);

  bool empty() const { return weight_ == 0; }
  /// How far the first category of the last answer lay in the mean of all frames, and in the last one, where it counts
  /// as far as the farthest if it was not met; 0 before an answer.
  std::uint32_t meanDistance() const;
  std::uint32_t lastDistance() const;

 private:
  struct Entry {
    std::uint64_t distances = 0;       // sum, in 1/2^16
    std::uint64_t scores = 0;          // sum of permille, in 1/2^16
    Neighbour last{Search::kNone, 0};  // where it was met last
    std::uint32_t frame = 0;           // in which that was
  };
  bool closer(std::uint32_t a, std::uint32_t b) const;
  void hold(std::uint32_t parts);

  std::vector<Entry> categories_;
  std::vector<std::uint32_t> order_;
  std::uint64_t weight_ = 0;  // of the frames, in 1/2^16
  std::uint32_t first_ = Search::kNone;
  std::uint32_t frames_ = 0, farthest_ = 0;  // that were seen; how far the farthest was that the last one met
};

}  // namespace voxid
