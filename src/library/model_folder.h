// SPDX-License-Identifier: BSD-3-Clause
// A folder of CAD models: <category>/<model>.<ext>, and what library.json says about them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "voxid/core/status.h"

namespace voxid {

struct ModelFile {
  std::string category, name;  ///< the file's name without its extension
  std::string file;            ///< <category>/<file>
  std::string path;
  std::string licence, origin;
  std::uint32_t synset = 0;
  std::string sense;      ///< of the category: the synset's name in NLTK's form
  std::string hypernyms;  ///< of the category: from WordNet's root to the synset, as Index::hypernymsOf
  std::string clash;      ///< not empty: another file of this name was there before
};

struct ModelFolder {
  std::vector<ModelFile> models;        ///< by category, then file
  std::vector<std::string> categories;  ///< every folder, by name
};

/// Synsets are those of library.json, else of voxid's own table of categories.
Result<ModelFolder> listModels(const std::string& folder);

}  // namespace voxid
