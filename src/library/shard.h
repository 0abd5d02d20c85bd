// SPDX-License-Identifier: BSD-3-Clause
// What a build keeps of a finished model until the index is whole, so that an interrupted build can go on.
#pragma once

#include <string>

#include "model_folder.h"
#include "model_views.h"
#include "voxid/core/status.h"

namespace voxid {

/// Everything that the views of a model depend on: a shard with another origin is not used.
struct ShardOrigin {
  std::string file;  ///< <category>/<file>
  std::uint64_t file_bytes = 0;
  std::int64_t file_mtime_ns = 0;
  format::Parameters parameters{};
  std::uint32_t views_every = 1;
  bool keep_surface = false;

  std::string bytes() const;
};
ShardOrigin originOf(const ModelFile& model, const format::Parameters& parameters, const ViewChoice& choice);

std::string shardPath(const std::string& parts, const ModelFile& model);

/// Written beside and renamed; checked by a sum when read, so a power cut costs a model and nothing else.
Status writeShard(const std::string& path, const ShardOrigin& origin, const ModelViews& views);

/// Written beside `path` and renamed.
Status writeWhole(const std::string& path, const std::string& text);

/// CannotDo if there is none of this origin; Damaged if it is not whole.
Result<ModelViews> readShard(const std::string& path, const ShardOrigin& origin);

}  // namespace voxid
