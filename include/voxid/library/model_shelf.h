// SPDX-License-Identifier: BSD-3-Clause
// Surfaces of an index's models, read once.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "voxid/core/index.h"
#include "voxid/geometry/alignment.h"
#include "voxid/geometry/symmetry.h"

namespace voxid {

/// The file of model <category>/<name> in a folder; the first by name if several could be it, as in a build.
Result<std::string> meshOf(const std::string& models, const std::string& name);

/// <category>/<name> of a model of an index.
std::string fullNameOf(const Index& index, std::uint32_t model);

/// Threads may share it.
class ShelvedModel {
 public:
  /// `kept`: the surface's symmetry, if it is known.
  explicit ShelvedModel(ModelSurface surface, std::optional<Symmetry> kept = {});

  const AlignableModel model;
  /// What was kept; else found when it is first asked for, as names do without it and it takes longer than all else.
  const Symmetry& symmetry() const;

 private:
  mutable std::once_flag looked_;
  mutable std::optional<Symmetry> symmetry_;
};

/// Reads a model when it is first asked for, and keeps those that were asked for last: its surface from the index where
/// that keeps it, else from the folder of models. One object a thread.
class ModelShelf {
 public:
  /// Of all models together: some thousands of the usual size (100 to 200 KiB).
  static constexpr std::size_t kMostBytes = std::size_t{512} << 20;

  /// `models`: the folder that the index was made from; may be empty if it keeps the surfaces. Beyond `most_bytes` the
  /// models that were not asked for longest are forgotten; the one asked for last is always kept.
  ModelShelf(std::shared_ptr<const Index> index, std::string models, std::size_t most_bytes = kMostBytes)
      : index_(std::move(index)), models_(std::move(models)), most_bytes_(most_bytes) {}

  /// `model`: a number below index.models().size. CannotDo, every time, if it has no surface that can be read; Damaged
  /// if the index's is not whole.
  Result<std::shared_ptr<const ShelvedModel>> find(std::uint32_t model);

  std::size_t bytes() const { return bytes_; }  ///< of the models that are kept, about

 private:
  struct Book {
    Result<std::shared_ptr<const ShelvedModel>> model;
    std::size_t bytes = 0;
    std::uint64_t last_asked = 0;
  };
  void forgetOldest();

  Result<std::shared_ptr<const ShelvedModel>> read(std::uint32_t model) const;

  std::shared_ptr<const Index> index_;
  std::string models_;
  std::size_t most_bytes_, bytes_ = 0;
  std::uint64_t asked_ = 0;
  std::map<std::uint32_t, Book> books_;  // by model
};

}  // namespace voxid
