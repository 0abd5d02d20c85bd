// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "voxid/core/projection.h"
#include "voxid/library/builder.h"

namespace voxid {

/// How a projection is learnt from CAD models.
struct TrainOptions {
  std::string models;  ///< folder of folders, as for a build
  std::string out;     ///< the projection file (.vxp)
  int jobs = 1;
  int views_every = 1;               ///< of the 80 directions; 10 instead of 20 views a model cost two points,
                                     ///< 20 instead of 80 none (doc/descriptor.md)
  std::uint32_t lists = 1024;        ///< centroids for the quick search, at most one a view
  DescriptorParams params{6000, 1};  ///< of the depth descriptor, for every index made with the projection
  double shrinkage = 0.03;  ///< share of the mean variance added to every direction; 0.01 to 0.1 cost a point at most
  std::vector<std::string> without;  ///< categories that are left out
  MeshReaderLimits mesh_limits;
};

struct TrainReport {
  int categories = 0, models = 0, views = 0;
  std::uint64_t bytes = 0;
  int calibration_samples = 0;
  std::vector<SkippedModel> skipped;
};

/// Renders the models, every second view of a deformed copy (another thing of its category), learns the map under which
/// categories differ most (linear discriminant analysis), rounds it to integers, learns the centroids (Lloyd's
/// algorithm) and the calibration, and writes the file. Floating point: the same machine gives the same bytes. Call it
/// from a process with one thread. Fails as buildIndex does, and with NothingFound where fewer than two categories or
/// fewer views than a code has numbers are left.
Result<TrainReport> trainProjection(const TrainOptions& options, BuildListener& listener);

}  // namespace voxid
