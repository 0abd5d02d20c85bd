// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "voxid/core/index.h"

namespace voxid {

struct Neighbour {
  std::uint32_t view = 0;
  std::uint32_t distance = 0;  ///< L1, 0 to 106,080
};
/// Nearer first; the lower view number wins a tie, so that the order never depends on how the search went.
inline bool operator<(Neighbour a, Neighbour b) {
  return a.distance != b.distance ? a.distance < b.distance : a.view < b.view;
}

/// What a search found. Both lists are sorted and belong to the search object until its next call.
struct Nearest {
  Span<const Neighbour> views;       ///< the nearest views, at most `kNearestViews`
  Span<const Neighbour> categories;  ///< of each category that was met, its nearest view
  std::uint32_t scanned = 0;         ///< descriptors compared
};
constexpr int kNearestViews = 20;

/// Finds the nearest views of one index. All memory is taken at construction. One object a thread.
class Search {
 public:
  virtual ~Search() = default;
  /// `code` is as long as the index's code_bytes. `left_out_model`: views of this model do not count (for calibration).
  virtual const Nearest& find(const std::uint8_t* code, std::uint32_t left_out_model = kNone) = 0;
  static constexpr std::uint32_t kNone = 0xffffffff;
};

/// Compares with every view: the definition that every other search is measured against.
std::unique_ptr<Search> makeExactSearch(std::shared_ptr<const Index> index);

/// The paper's locality-sensitive hashing (Sec. IV.B): the buckets whose keys lie within `radius` bits of the query's
/// are compared in full. The ball grows by two bits until it holds at least five categories (or everything).
std::unique_ptr<Search> makeLshSearch(std::shared_ptr<const Index> index, int radius_bits);

}  // namespace voxid
