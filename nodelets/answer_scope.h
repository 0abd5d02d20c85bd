// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <mutex>
#include <string>

#include "voxid/geometry/longest_extent.h"
#include "voxid/library/allowed_categories.h"

namespace voxid {

/// What objects may be in an index, by the parameters categories, size and confirmed_sizes. Shared between threads.
class AnswerScope {
 public:
  /// `list`: the file of ~categories; empty: all. If it cannot be used all may be, and trouble() says why.
  /// `confirmed`: the file of ~confirmed_sizes; empty: none. If it cannot be used the reviewed sizes alone count.
  AnswerScope(const Index& index, const std::string& list, bool size, const std::string& confirmed = "");

  /// An object so long is of this category of the index: kept in the file, and counted from now on. CannotDo if there
  /// is no such file to keep it in.
  Status confirm(const Index& index, const std::string& category, int longest_mm);

  /// What one thread needs for of().
  struct Workspace {
    LongestExtent extent;
    AllowedCategories fitting;
  };
  /// As SearchScope::categories; valid until the workspace is used again.
  Span<const std::uint8_t> of(const DepthView& depth, Span<const std::uint32_t> pixels, Workspace& workspace) const;

  const std::string& trouble() const { return trouble_; }

 private:
  AllowedCategories listed_;
  std::string confirmed_;
  mutable std::mutex mutex_;                // of the pointer
  std::shared_ptr<const SizeTable> sizes_;  // null: size does not count
  std::string trouble_;
};

}  // namespace voxid
