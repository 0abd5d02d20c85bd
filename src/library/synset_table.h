// SPDX-License-Identifier: BSD-3-Clause
// voxid's own table of categories and what WordNet has above them: cfg/synsets.yaml and cfg/hypernyms.txt, compiled in.
#pragma once

#include <cstdint>
#include <string>

namespace voxid {

struct KnownSynset {
  std::uint32_t offset = 0;      ///< of WordNet 3.0's nouns; 0 = not known
  std::string sense, hypernyms;  ///< as ModelRecord
};

/// Offset and sense; nothing known of a category that is not in the table.
KnownSynset synsetOfCategory(const std::string& category);
/// Empty for an offset that no category of the table has.
std::string senseOfOffset(std::uint32_t offset);
/// From the root to the sense, joined by slashes. Empty for one that the table does not have.
std::string hypernymPath(const std::string& sense);

}  // namespace voxid
