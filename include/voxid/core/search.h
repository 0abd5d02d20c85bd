// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "voxid/core/classify_params.h"
#include "voxid/core/index.h"

namespace voxid {

struct Neighbour {
  std::uint32_t view = 0;
  std::uint32_t distance = 0;  ///< of the index's profile: L1, 0 to 106,080, or squared Euclidean, 0 to 4,129,024;
                               ///< from makeSearch of "default" by movedDistance (refine.h), 0 to 518,400
};
/// Nearer first; the lower view number wins a tie, so that the order never depends on how the search went.
inline bool operator<(Neighbour a, Neighbour b) {
  return a.distance != b.distance ? a.distance < b.distance : a.view < b.view;
}

/// What a search found. Both lists are sorted and belong to the search object until its next call.
struct Nearest {
  Span<const Neighbour> views;       ///< the nearest views, at most `kNearestViews`
  Span<const Neighbour> categories;  ///< of each category that was met, its nearest view
  std::uint32_t scanned = 0;         ///< codes compared
};
constexpr int kNearestViews = 64;
/// A search that does not compare every view gives the categories of so many of the nearest, at least.
constexpr int kCategoryPool = 256;

/// Which views count in a search. By default all.
struct SearchScope {
  static constexpr std::uint32_t kNone = 0xffffffff;

  /// By category of the index: those that are 0 do not count. As long as index.categories(), or empty: all count.
  Span<const std::uint8_t> categories;
  std::uint32_t left_out_model = kNone;  ///< does not count (for calibration)
};

/// Finds the nearest views of one index. All memory is taken at construction. One object a thread.
class Search {
 public:
  virtual ~Search() = default;
  /// `code` is as long as the index's code_bytes. Nothing is found if no view is in scope.
  virtual const Nearest& find(const std::uint8_t* code, const SearchScope& scope = {}) = 0;
  static constexpr std::uint32_t kNone = SearchScope::kNone;
};

/// Compares with every view: the definition that every other search is measured against.
std::unique_ptr<Search> makeExactSearch(std::shared_ptr<const Index> index);

constexpr int kPaperRadiusBits = 4;  ///< the paper's k (Sec. IV.B)

/// The paper's locality-sensitive hashing (Sec. IV.B), for an index of profile "paper": the buckets whose keys lie
/// within `radius_bits` of the query's (0 to 52, clamped) are compared in full. The ball grows by two bits until it
/// holds at least five categories (or everything).
std::unique_ptr<Search> makeLshSearch(std::shared_ptr<const Index> index, int radius_bits);

/// The learnt hash of profile "default": the `lists` lists whose centroids lie nearest the query are compared in full
/// (of a scope as many more as it has fewer views, so that as many views are compared), more of them, twice as many
/// each time, until five categories are met (or everything was compared). Of the categories those are given that the
/// nearest views belong to, kCategoryPool at least, or as many more as it takes to meet five. The recall of a number of
/// lists: doc/benchmarks.md.
std::unique_ptr<Search> makeListSearch(std::shared_ptr<const Index> index, int lists);

/// Exact (of "paper" by sketches, where the index has them: sketch.h), or the hash search of the index's profile.
struct SearchParams {
  bool exact = true;
  int radius_bits = kPaperRadiusBits;  ///< "paper": 0 to 52, clamped; below 0: exact
  int lists = ClassifyParams{}.lists;  ///< "default": 1 to 65,536, clamped
};
inline bool operator==(const SearchParams& a, const SearchParams& b) {
  return a.exact == b.exact && a.radius_bits == b.radius_bits && a.lists == b.lists;
}
inline SearchParams searchParamsOf(const ClassifyParams& params) {
  return {params.exact, params.radius_bits, params.lists};
}
/// Of profile "default" what was found is measured anew, by codes moved towards their categories' means (refine.h). A
/// model that is left out is left out of its category's mean, too.
std::unique_ptr<Search> makeSearch(std::shared_ptr<const Index> index, const SearchParams& params);

}  // namespace voxid
