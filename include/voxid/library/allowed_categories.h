// SPDX-License-Identifier: BSD-3-Clause
// What an object may be, by what its place holds and by its size.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "voxid/core/index.h"
#include "voxid/library/confirmed_sizes.h"

namespace voxid {

/// By category of an index: 0: it is no answer (SearchScope::categories). Empty: all may be.
using AllowedCategories = std::vector<std::uint8_t>;

/// Those that a file names, one a line; names that the index does not have are passed over. CannotDo if the file cannot
/// be read or none is left.
Result<AllowedCategories> readAllowedCategories(const std::string& path, const Index& index);

/// The categories of an index with their least and most longest extents: as cfg/sizes.yaml has them, refined by what
/// was confirmed. Where kEnough things of a category were, its range is theirs, and kMargin of the least and the most
/// beyond; fewer only widen the reviewed range, to as much.
class SizeTable {
 public:
  /// From so many on the next thing of a category lies between the least and the most of them in two of three cases.
  static constexpr std::size_t kEnough = 5;
  /// For the others, and for sides from which none was seen: chosen, not measured.
  static constexpr double kMargin = 0.25;

  explicit SizeTable(const Index& index, const ConfirmedSizes& confirmed = {});

  /// Of `among` those that may be so long (LongestExtent). If that leaves none, `among`: the table is then no help.
  /// Written to `fit`, which allocates nothing once it has been used.
  void find(double longest_mm, const AllowedCategories& among, AllowedCategories* fit) const;

 private:
  struct Range {
    double least_mm = 0, most_mm = 1e9;
  };
  Range* rangeOf(const Index& index, const std::string& category);  // null: the index does not have it
  void review(const Index& index);
  void refine(const std::vector<int>& confirmed_mm, Range* range) const;

  std::vector<Range> ranges_;  // by category
};

}  // namespace voxid
