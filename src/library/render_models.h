// SPDX-License-Identifier: BSD-3-Clause
// Every model of a folder becomes a shard of described views.
#pragma once

#include <functional>
#include <map>
#include <string>

#include "model_folder.h"
#include "model_views.h"
#include "voxid/core/index_format.h"
#include "voxid/core/status.h"
#include "voxid/library/builder.h"
#include "voxid/library/mesh_reader.h"

namespace voxid {

struct RenderWork {
  const ModelFolder& folder;
  const std::string& parts;  ///< folder of the shards
  BuildListener& listener;
  int jobs = 1;
  ViewChoice choice{};
  format::Parameters parameters{};  ///< that `makeEncode` describes with; shards made with others are made anew
  MeshReaderLimits mesh_limits{};
  std::function<EncodeView()> makeEncode{};  ///< called once in each worker
};

/// In worker processes. `died` takes the models whose worker died, by number, and how.
Status renderModels(const RenderWork& work, std::map<int, std::string>& died);

}  // namespace voxid
