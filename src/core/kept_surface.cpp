// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/core/kept_surface.h"

#include <algorithm>
#include <cstddef>
#include <cstring>

namespace voxid {
namespace {

/// The i-th three numbers; they need not be aligned.
template <typename T>
std::array<T, 3> threeAt(const std::uint8_t* from, std::uint32_t i) {
  std::array<T, 3> three;
  std::memcpy(three.data(), from + std::size_t{i} * sizeof three, sizeof three);
  return three;
}

}  // namespace

std::optional<KeptSurface> KeptSurface::of(Span<const std::uint8_t> bytes) {
  KeptSurface kept;
  format::Surface& header = kept.header_;
  if (bytes.size < sizeof header) return {};
  std::memcpy(&header, bytes.data, sizeof header);
  if (header.zero[0] != 0 || header.vertices > format::kMaxSurfaceVertices) return {};
  const std::uint64_t vertex_bytes = std::uint64_t{header.vertices} * sizeof(std::int16_t) * 3;
  const std::uint64_t triangle_bytes = std::uint64_t{header.triangles} * sizeof(std::uint16_t) * 3;
  if (bytes.size != sizeof header + vertex_bytes + triangle_bytes) return {};
  kept.vertices_ = bytes.data + sizeof header;
  kept.triangles_ = kept.vertices_ + vertex_bytes;
  for (std::uint32_t i = 0; i < header.triangles; ++i) {
    const auto corners = kept.triangle(i);
    if (*std::max_element(corners.begin(), corners.end()) >= header.vertices) return {};
  }
  return kept;
}

std::array<std::int16_t, 3> KeptSurface::vertex(std::uint32_t i) const { return threeAt<std::int16_t>(vertices_, i); }

std::array<std::uint16_t, 3> KeptSurface::triangle(std::uint32_t i) const {
  return threeAt<std::uint16_t>(triangles_, i);
}

}  // namespace voxid
