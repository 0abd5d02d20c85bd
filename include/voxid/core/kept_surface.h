// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "voxid/core/index_format.h"
#include "voxid/core/span.h"

namespace voxid {

/// A model's surface as an index keeps it: format::Surface, then vertices, then triangles. Looks at bytes that somebody
/// else holds.
class KeptSurface {
 public:
  /// Empty if the length is not the one that the numbers demand, there are too many vertices, a triangle names a vertex
  /// that is not there, or padding is not zero.
  static std::optional<KeptSurface> of(Span<const std::uint8_t> bytes);

  const format::Surface& header() const { return header_; }
  /// In 1/format::kSurfaceUnits of the box's diagonal, from the box's centre. `i` below header().vertices.
  std::array<std::int16_t, 3> vertex(std::uint32_t i) const;
  /// Numbers of vertices. `i` below header().triangles.
  std::array<std::uint16_t, 3> triangle(std::uint32_t i) const;

 private:
  format::Surface header_{};
  const std::uint8_t *vertices_ = nullptr, *triangles_ = nullptr;
};

}  // namespace voxid
