// SPDX-License-Identifier: BSD-3-Clause
// When two categories are as good as one: their shapes are alike, or their synsets lie on one path.
#pragma once

#include <map>
#include <string>

#include "voxid/core/index.h"
#include "voxid/core/status.h"

namespace voxid::cli {

/// Category -> the group of shapes that nobody can tell apart. A category that is not there is alone.
using LookAlikes = std::map<std::string, std::string>;

/// YAML: `groups`, each a map of categories to why they are in it. The file, or, if `path` is empty, voxid's own
/// (cfg/look_alikes.yaml). No category is in two groups.
Result<LookAlikes> readLookAlikes(const std::string& path);

/// Category -> its path of hypernyms between slashes: "/entity.n.01/.../mug.n.04/". Empty in an index without
/// hypernyms.
using SynsetPaths = std::map<std::string, std::string>;
SynsetPaths synsetPathsOf(const Index& index);

/// The synset of one category is that of the other, above it or below it. False for a category without synset, unless
/// both are the same.
bool sameOrAbove(const SynsetPaths& paths, const std::string& a, const std::string& b);

}  // namespace voxid::cli
