// SPDX-License-Identifier: BSD-3-Clause
// Numbers of things in sentences.
#pragma once

#include <cstdint>
#include <string>

namespace voxid::cli {

/// "1 view", "2 views"; `plural` where an s is not enough.
inline std::string counted(std::uint64_t number, const std::string& noun, const std::string& plural = "") {
  return std::to_string(number) + " " + (number == 1 ? noun : plural.empty() ? noun + "s" : plural);
}

/// What an index holds, or is to hold.
inline std::string countedModels(std::uint64_t views, std::uint64_t models, std::uint64_t categories) {
  return counted(views, "view") + " of " + counted(models, "model") + " in " +
         counted(categories, "category", "categories");
}

}  // namespace voxid::cli
