// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "voxid/core/index_format.h"
#include "voxid/library/index_writer.h"

namespace voxid {

/// Puts an index together model by model. What is done waits on disk, so that memory grows with the texts of the models
/// (names, licences, origins; each once) and not with their views: some 100 bytes a model, beside 30 MB.
class IndexAssembler {
 public:
  /// `path`: the index to be made. What waits, lies in its folder in files without names: as much again as the index.
  IndexAssembler(const Profile& profile, std::vector<format::Direction> directions, const std::string& path);
  ~IndexAssembler();

  /// Takes the next model, in ascending order of category and name (bytewise). Refuses what writeIndex refuses.
  Status add(const ModelRecord& model);
  std::uint32_t models() const;  ///< so far, and the number that the next one gets

  /// All of it as an index: beside `path`, fsynced, renamed. May be called again, with other things learnt; after the
  /// first call no model is taken any more.
  Status write(const std::string& path, const format::Calibration& calibration,
               const std::optional<format::Confidence>& confidence);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace voxid
