// SPDX-License-Identifier: BSD-3-Clause
// Surfaces of an index's models, read once.
#pragma once

#include <map>
#include <memory>
#include <string>

#include "voxid/core/index.h"
#include "voxid/geometry/alignment.h"
#include "voxid/geometry/symmetry.h"

namespace voxid::cli {

/// The file of model <category>/<name> in a folder; the first by name if several could be it, as in a build.
Result<std::string> meshOf(const std::string& models, const std::string& name);

/// <category>/<name> of a model of an index.
std::string fullNameOf(const Index& index, std::uint32_t model);

struct ShelvedModel {
  AlignableModel model;
  Symmetry symmetry;
};

/// Reads a model when it is first asked for. One object a thread.
class ModelShelf {
 public:
  /// `models`: the folder that an index was made from.
  explicit ModelShelf(std::string models) : models_(std::move(models)) {}

  /// `name`: <category>/<model>. CannotDo, every time, if the folder has no such model or it cannot be read.
  Result<std::shared_ptr<const ShelvedModel>> find(const std::string& name);

 private:
  std::string models_;
  std::map<std::string, Result<std::shared_ptr<const ShelvedModel>>> read_;
};

}  // namespace voxid::cli
