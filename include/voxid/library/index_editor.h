// SPDX-License-Identifier: BSD-3-Clause
// Changes of an index that leave the rest as it is. Readers keep the old file until they open the new one; two writers
// of one index wait for nobody: the second is refused.
#pragma once

#include <string>
#include <vector>

#include "voxid/core/status.h"
#include "voxid/library/builder.h"

namespace voxid {

/// What to do with a model that is there already, under the same category and name.
enum class Clash { Refuse, Replace };

/// Renders the models of `options.models`, describes them with the index's own profile (`options.profile` does not
/// count), and takes them into the index `options.out`. Fails as buildIndex and mergeIndices do; then the index stays
/// as it was.
Result<BuildReport> addModels(const BuildOptions& options, Clash clash, BuildListener& listener);

/// Takes out of the index at `path` what `wanted` names: categories (mug) or models (mug/blue_mug). NothingFound for a
/// name that is not there, or if nothing would be left. The index stays as it was if that fails.
Status removeModels(const std::string& path, const std::vector<std::string>& wanted);

/// Writes what all the indices of `paths` hold to `out`, which may be one of them, model by model: memory does not grow
/// with their views. CannotDo if the profiles or directions differ, if a category has two synsets, or for a clash that
/// is refused; Damaged if one of them is. The calibration of most samples stays.
Status mergeIndices(const std::vector<std::string>& paths, const std::string& out, Clash clash);

}  // namespace voxid
