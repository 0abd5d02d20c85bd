// SPDX-License-Identifier: BSD-3-Clause
// Surfaces of an index's models, read once.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>

#include "voxid/core/index.h"
#include "voxid/geometry/alignment.h"
#include "voxid/geometry/symmetry.h"

namespace voxid {

/// The file of model <category>/<name> in a folder; the first by name if several could be it, as in a build.
Result<std::string> meshOf(const std::string& models, const std::string& name);

/// <category>/<name> of a model of an index.
std::string fullNameOf(const Index& index, std::uint32_t model);

struct ShelvedModel {
  AlignableModel model;
  Symmetry symmetry;
};

/// Reads a model when it is first asked for, and keeps those that were asked for last. One object a thread.
class ModelShelf {
 public:
  /// Of all models together: some thousands of the usual size (100 to 200 KiB).
  static constexpr std::size_t kMostBytes = std::size_t{512} << 20;

  /// `models`: the folder that an index was made from. Beyond `most_bytes` the models that were not asked for longest
  /// are forgotten; the one asked for last is always kept.
  explicit ModelShelf(std::string models, std::size_t most_bytes = kMostBytes)
      : models_(std::move(models)), most_bytes_(most_bytes) {}

  /// `name`: <category>/<model>. CannotDo, every time, if the folder has no such model or it cannot be read.
  Result<std::shared_ptr<const ShelvedModel>> find(const std::string& name);

  std::size_t bytes() const { return bytes_; }  ///< of the models that are kept, about

 private:
  struct Book {
    Result<std::shared_ptr<const ShelvedModel>> model;
    std::size_t bytes = 0;
    std::uint64_t last_asked = 0;
  };
  void forgetOldest();

  std::string models_;
  std::size_t most_bytes_, bytes_ = 0;
  std::uint64_t asked_ = 0;
  std::map<std::string, Book> books_;
};

}  // namespace voxid
