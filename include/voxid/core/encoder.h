// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "voxid/core/depth_view.h"
#include "voxid/core/descriptor.h"
#include "voxid/core/projection.h"
#include "voxid/core/span.h"

namespace voxid {

/// How views become codes, and how codes are compared.
struct Profile {
  DescriptorParams params;                       ///< of "paper"; "default" has those of its projection
  std::shared_ptr<const Projection> projection;  ///< null: "paper", the 416 bins by L1. Else "default": the depth
                                                 ///< descriptor, projected, by squared Euclidean distance
  bool small = false;                            ///< "default": codes of kSmallCodeBytes instead of kCodeBytes
  std::size_t codeBytes() const {
    if (!projection) return std::size_t{kDescriptorBytes};
    return small ? kSmallCodeBytes : kCodeBytes;
  }
};

/// Turns what a camera sees of an object into the code that an index stores. All memory is taken at construction. One
/// object a thread.
class Encoder {
 public:
  virtual ~Encoder() = default;
  /// Writes the profile's codeBytes() to `code`, which mean something only if the status is Ok. `pixels`: row * width +
  /// column.
  virtual DescribeStatus encode(const DepthView& depth, Span<const std::uint32_t> pixels, std::uint8_t* code) = 0;
};
std::unique_ptr<Encoder> makeEncoder(const Profile& profile);

}  // namespace voxid
