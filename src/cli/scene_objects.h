// SPDX-License-Identifier: BSD-3-Clause
// Labelled objects of real scenes (layout of the modified Object Segmentation Database).
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "depth_file.h"
#include "voxid/core/index.h"
#include "voxid/core/status.h"

namespace voxid::cli {

/// What a scene's category may be called in an index: "tin" is right as "can". An empty list: nothing is right, such
/// objects are left out. A category that is not there is called by its own name.
using Aliases = std::map<std::string, std::vector<std::string>>;

/// An object that stands alone and whole.
struct SceneObject {
  std::string name;                        ///< scene and id, for people
  std::shared_ptr<const DepthFile> depth;  ///< of its scene
  std::vector<std::string> right;          ///< categories that are right; the first is its class
  std::vector<std::uint32_t> true_pixels;  ///< labelled, with depth
  std::vector<std::uint32_t> own_pixels;   ///< of voxid's cluster that is the object; empty if none is
};

struct SceneObjects {
  int scenes = 0;
  std::vector<SceneObject> objects;
  std::map<std::string, int> left_out;  ///< objects that no category of the index fits, by their category
};

/// Reads DIR/objects.json and, for each scene that it names, NAME_depth.png and NAME_labels.png (0 no depth, 1 to 9
/// table, else id * 10 + part). Takes the objects with alone_at_2cm, without truncated and exclude. A cluster is an
/// object if they share at least half of the pixels of either.
Result<SceneObjects> readSceneObjects(const std::string& folder, const Index& index, const Aliases& aliases);

/// A JSON object: category -> list of categories. The file, or, if `path` is empty, voxid's own (cfg/aliases.json).
Result<Aliases> readAliases(const std::string& path);

}  // namespace voxid::cli
