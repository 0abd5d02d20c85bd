// SPDX-License-Identifier: BSD-3-Clause
// Folders of models, each described as a whole.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "compare_views.h"
#include "voxid/core/descriptor.h"

namespace voxid::cli {

/// What whole models are compared by; all by L1.
struct WholeDescriptor {
  const char* name;  ///< as in the rows of `voxid eval --retrieval`
  int bins;          ///< floats; a multiple of 8
};
constexpr std::array<WholeDescriptor, 3> kWholeDescriptors{{{"paper", 416}, {"d2", 160}, {"esf", 640}}};

struct WholeModels {
  std::vector<std::string> categories, names;      ///< by model; names are <category>/<file>
  std::vector<std::unique_ptr<CodeTable>> tables;  ///< by descriptor: floats, a row a model; unreadable ones have none
  std::vector<std::string> reasons;                ///< by model: why the mesh cannot be read; empty if it can

  const float* bins(std::size_t descriptor, std::size_t model) const {
    return reinterpret_cast<const float*>(tables[descriptor]->code(model));
  }
};

/// Describes surfacePoints() of every mesh in FOLDER/<category>/, in `jobs` processes. Call it from a process with one
/// thread. CannotDo: no such folder. NothingFound: no mesh in it that can be read.
Result<WholeModels> describeWholeModels(const std::string& folder, const DescriptorParams& params, int jobs);

}  // namespace voxid::cli
