// SPDX-License-Identifier: BSD-3-Clause
#include "inverse_depth.h"

#include <cstring>

#include "../core/vectorised.h"

namespace voxid {
namespace {

// Both units give the same quotient: numerator and whole millimetres are exact in float, and so is 1000 times either.
constexpr float kUnitsTimesMm = 1e6f * kUnitsPerKm;

struct RangeMm {
  int nearest, farthest;
};

VOXID_VECTORISED std::uint32_t invertMillimetres(const unsigned char* pixels, int width, RangeMm range,
                                                 std::int32_t* out) {
  std::uint32_t valid = 0;
  for (int u = 0; u < width; ++u) {
    std::uint16_t depth_mm;
    std::memcpy(&depth_mm, pixels + 2 * static_cast<std::size_t>(u), sizeof depth_mm);
    const bool inside = (depth_mm >= range.nearest) & (depth_mm <= range.farthest);
    const auto inverse = static_cast<std::int32_t>(kUnitsTimesMm / static_cast<float>(inside ? depth_mm : 1) + 0.5f);
    out[u] = inside ? inverse : 0;
    valid += static_cast<std::uint32_t>(inside);
  }
  return valid;
}

std::uint32_t invertMetres(const DepthView& depth, int v, RangeMm range, std::int32_t* out) {
  std::uint32_t valid = 0;
  for (int u = 0; u < depth.width_px; ++u) {
    const std::int32_t depth_um = depth.depthUm(u, v);
    const bool inside = depth_um >= range.nearest * 1000 && depth_um <= range.farthest * 1000;
    out[u] = inside ? static_cast<std::int32_t>(kUnitsTimesMm * 1000.0f / static_cast<float>(depth_um) + 0.5f) : 0;
    valid += inside;
  }
  return valid;
}

}  // namespace

void invert(const DepthView& depth, int min_depth_mm, int max_depth_mm, InverseDepth& inverse) {
  inverse.width_px = depth.width_px;
  inverse.height_px = depth.height_px;
  inverse.values.resize(static_cast<std::size_t>(depth.width_px) * depth.height_px);
  inverse.valid = 0;
  const RangeMm range{min_depth_mm, max_depth_mm};
  for (int v = 0; v < depth.height_px; ++v) {
    std::int32_t* out = inverse.values.data() + static_cast<std::size_t>(v) * depth.width_px;
    const auto* pixels = static_cast<const unsigned char*>(depth.data) + static_cast<std::size_t>(v) * depth.row_bytes;
    inverse.valid += depth.unit == DepthUnit::MillimetreU16 ? invertMillimetres(pixels, depth.width_px, range, out)
                                                            : invertMetres(depth, v, range, out);
  }
}

}  // namespace voxid
