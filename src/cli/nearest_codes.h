// SPDX-License-Identifier: BSD-3-Clause
// The nearest codes of a table, as the classifier wants them.
#pragma once

#include <vector>

#include "voxid/core/search.h"

namespace voxid::cli {

/// Collects candidates in any order; `result` belongs to it until the next `clear`.
class NearestCodes {
 public:
  explicit NearestCodes(const Index& index);

  void clear();
  void add(std::uint32_t view, std::uint32_t distance);
  const Nearest& result();

 private:
  const Index& index_;
  std::vector<Neighbour> found_, categories_;
  Nearest result_;
};

}  // namespace voxid::cli
