// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstring>

#include "voxid/capture/device.h"

namespace voxid {
namespace {

struct Rgb {
  std::uint8_t r, g, b;
};

template <typename Pixel>
void copyRow(const Pixel* from, Pixel* to, int width, bool mirrored) {
  if (mirrored)
    std::reverse_copy(from, from + width, to);
  else
    std::copy(from, from + width, to);
}

void toMillimetres(std::uint16_t* row, int width) {
  for (int u = 0; u < width; ++u) row[u] = static_cast<std::uint16_t>((row[u] + 5) / 10);
}

}  // namespace

void CaptureFrame::copyTo(void* to, std::size_t to_row_bytes) const {
  for (int v = 0; v < height_px; ++v) {
    const auto* from_row = static_cast<const std::uint8_t*>(data) + static_cast<std::size_t>(v) * row_bytes;
    auto* to_row = static_cast<std::uint8_t*>(to) + static_cast<std::size_t>(v) * to_row_bytes;
    if (sensor == Sensor::Colour) {
      copyRow(reinterpret_cast<const Rgb*>(from_row), reinterpret_cast<Rgb*>(to_row), width_px, mirrored);
      continue;
    }
    auto* depth_row = reinterpret_cast<std::uint16_t*>(to_row);
    copyRow(reinterpret_cast<const std::uint16_t*>(from_row), depth_row, width_px, mirrored);
    if (tenth_mm) toMillimetres(depth_row, width_px);
  }
}

}  // namespace voxid
