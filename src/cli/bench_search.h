// SPDX-License-Identifier: BSD-3-Clause
// Searches that are compared with one another: all find the ten nearest codes of one index.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "voxid/core/index.h"

namespace voxid::cli {

constexpr std::size_t kTen = 10;

/// The metric of an index's codes.
using CodeDistance = std::uint32_t (*)(const std::uint8_t* a, const std::uint8_t* b);

/// A search with one setting that trades time for recall.
struct Contender {
  std::string name, knob;     ///< "query/hnswlib", "ef"
  std::vector<int> settings;  ///< in ascending order of cost
  int main_setting = -1;      ///< the one that the row shows; -1: the first of sufficient recall
  std::function<void(int setting)> prepare;
  /// Fills `ten` with the numbers of at most ten views, nearest first.
  std::function<void(const std::uint8_t* code, std::vector<std::uint32_t>& ten)> find;
  double bytes_per_view = 0;  ///< codes included
};

/// hnswlib and FLANN over the index's codes and in their metric, as far as voxid was built with them. Building them
/// takes a minute at 240,000 views.
std::vector<Contender> peersOf(const Index& index, CodeDistance distance);

}  // namespace voxid::cli
