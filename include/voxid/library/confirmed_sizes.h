// SPDX-License-Identifier: BSD-3-Clause
// How long things were whose category somebody confirmed.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "voxid/core/status.h"

namespace voxid {

/// By category the longest extents (LongestExtent) of confirmed objects, in whole millimetres, oldest first. As a file:
/// YAML, one line a category, as `mug: [112, 104]`.
class ConfirmedSizes {
 public:
  static constexpr std::size_t kMostEach = 100;  ///< of a category; the oldest go

  /// A file that is not there holds none. CannotDo if it cannot be read or is not such a file.
  static Result<ConfirmedSizes> read(const std::string& path);

  /// Readers of the file see it as it was or as it is. CannotDo if it cannot be written.
  Status write(const std::string& path) const;

  void add(const std::string& category, int longest_mm);
  const std::map<std::string, std::vector<int>>& longest_mm() const { return longest_mm_; }

 private:
  std::map<std::string, std::vector<int>> longest_mm_;
};

}  // namespace voxid
