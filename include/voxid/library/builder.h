// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "voxid/core/encoder.h"
#include "voxid/core/status.h"
#include "voxid/library/mesh_reader.h"

namespace voxid {

struct BuildOptions {
  std::string models;   ///< folder of folders: <category>/<model>.<ext>; links are followed; library.json if there
                        ///< (doc/build.md)
  std::string out;      ///< the index; what it held before stays readable until the new one is whole
  int jobs = 1;         ///< worker processes; the bytes of the index do not depend on it
  bool resume = false;  ///< take what an interrupted build of the same models and settings left in <out>.parts
  int views_every = 1;  ///< take every n-th of the 80 directions; 4 gives the 20 of the plain icosahedron
  bool keep_surfaces = false;  ///< each model's surface goes into the index, so that poses need no meshes
  Profile profile;             ///< that views are described with
  MeshReaderLimits mesh_limits;
};

/// A profile by its name, "default" or "paper". `projection`: a file, for "default"; empty: the shipped one. `pairs`:
/// lines drawn, for "paper"; 0: as many as usual. `code_bytes`: 32 or 48, for "default"; 0: 48. BadUse for what does
/// not go together or is out of range; else as Projection::read.
Result<Profile> profileOf(const std::string& descriptor, const std::string& projection, std::uint32_t pairs,
                          std::uint32_t code_bytes);

struct SkippedModel {
  std::string model;  ///< <category>/<file>
  std::string reason;
};

struct BuildReport {
  int categories = 0, models = 0, views = 0;     ///< in the index
  std::uint64_t bytes = 0;                       ///< of the index
  int calibration_samples = 0;                   ///< 0: too few models, the built-in curve was taken
  std::optional<format::Confidence> confidence;  ///< empty: too few models to learn how far answers may be trusted
  std::vector<SkippedModel> skipped;             ///< by name
  std::vector<std::string> empty_categories;     ///< folders without a readable model, by name
};

/// What a build says while it runs, from the calling thread. What it throws ends the build as a failure does.
class BuildListener {
 public:
  virtual ~BuildListener() = default;
  virtual void onModel(const std::string& /*model*/, int /*views*/) {}
  virtual void onSkipped(const SkippedModel& /*skipped*/) {}
  /// Some ten times a second. `done` counts skipped ones too.
  virtual void onProgress(int /*done*/, int /*models*/, std::uint64_t /*views*/) {}
};

/// Renders every model, describes the views, learns the calibration and writes the index. Models are worked on in
/// processes of their own: one that crashes costs the model that it was at. They are forked: no other thread may be
/// within voxid, Assimp or Embree meanwhile. CannotDo: no such folder, something cannot be written, another build of
/// the same index runs. BadUse: a value out of range. Damaged: library.json. NothingFound: no model is left. If it
/// fails, `out` is as it was before.
Result<BuildReport> buildIndex(const BuildOptions& options, BuildListener& listener);

/// Every `parts`-th model, from number `part` on.
struct BuildPart {
  int part = 0, parts = 1;
};

/// The work of buildIndex on a part of the models, up to the finished models in <out>.parts, which a buildIndex with
/// `resume` takes: so several processes, on several machines that share the folder, make one index. The report counts
/// models and views and lists what is skipped. Nobody is kept out; two that make the same model write the same bytes.
Result<BuildReport> buildPart(const BuildOptions& options, const BuildPart& part, BuildListener& listener);

}  // namespace voxid
