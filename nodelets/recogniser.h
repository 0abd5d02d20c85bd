// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "voxid/core/classifier.h"
#include "voxid/core/classify_params.h"
#include "voxid/core/descriptor.h"
#include "voxid/core/search.h"

namespace voxid {

/// Descriptor, search and classifier of one index in a row.
class Recogniser {
 public:
  explicit Recogniser(std::shared_ptr<const Index> index);

  /// What the pixels (row * width + column) show; `count` is zero if they have no extent.
  Answer recognise(const DepthView& depth, Span<const std::uint32_t> pixels, const ClassifyParams& params);
  const Index& index() const { return *index_; }

 private:
  Search& searchFor(const ClassifyParams& params);

  std::shared_ptr<const Index> index_;
  Describer describer_;
  std::unique_ptr<Search> search_;
  bool exact_ = true;
  int radius_bits_ = 0;
};

}  // namespace voxid
