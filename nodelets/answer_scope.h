// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "voxid/geometry/longest_extent.h"
#include "voxid/library/allowed_categories.h"

namespace voxid {

/// What objects may be in an index, by the parameters categories and size. Shared between threads.
class AnswerScope {
 public:
  /// `list`: the file of ~categories; empty: all. If it cannot be used all may be, and trouble() says why.
  AnswerScope(const Index& index, const std::string& list, bool size);

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
  std::optional<SizeTable> sizes_;
  std::string trouble_;
};

}  // namespace voxid
