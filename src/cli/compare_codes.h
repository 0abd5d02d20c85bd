// SPDX-License-Identifier: BSD-3-Clause
// What a view is turned into before it is compared: one class a descriptor.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "voxid/core/depth_view.h"
#include "voxid/core/encoder.h"
#include "voxid/core/index.h"
#include "voxid/core/span.h"

namespace voxid::cli {

/// A descriptor with its metric.
class ViewCode {
 public:
  ViewCode(std::string code_name, std::size_t code_bytes, bool code_is_refined = false)
      : name(std::move(code_name)), bytes(code_bytes), refined(code_is_refined) {}
  virtual ~ViewCode() = default;

  /// Writes `bytes` bytes; false if there is no answer for this view.
  virtual bool describe(const DepthView& depth, Span<const std::uint32_t> pixels, std::uint8_t* out) = 0;
  /// Twice as far is twice as large.
  virtual std::uint32_t distance(const std::uint8_t* a, const std::uint8_t* b) const = 0;

  const std::string name;   ///< as in the rows of `voxid eval --compare`
  const std::size_t bytes;  ///< a view; a multiple of 4
  const bool refined;       ///< what is nearest is then measured by movedDistance, as makeSearch does
};

/// PCL's ESF; D2 alone; the paper's descriptor in bytes and, for what rounding costs, in floats; all by L1. The paper's
/// is made with the index's parameters, where it is of that profile, else with the usual ones; then the index's own
/// descriptor comes last.
std::vector<std::unique_ptr<ViewCode>> comparedCodes(const Index& index);

/// How the paper's descriptor is made beside an index: as the index's own, where it is of that profile, else as usual.
DescriptorParams paperParamsOf(const Index& index);

/// The descriptor that the index was made with: describes as its views were, compares as its search does.
std::unique_ptr<ViewCode> ownCode(const Index& index);

/// The points of pixels that have depth.
std::vector<PointUm> pointsOf(const DepthView& depth, Span<const std::uint32_t> pixels);

}  // namespace voxid::cli
