// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <cstring>
#include <vector>

#include "voxid/core/index_format.h"

namespace voxid::test {

/// A tetrahedron whose corners are every second of a cube's, as an index keeps it.
inline std::vector<std::uint8_t> keptTetrahedron() {
  constexpr std::int16_t a = 18918;  // half a side of a cube of unit diagonal
  const format::Surface header{4, 4, {2, 3, 0}, {0}};
  const std::int16_t vertices[4][3] = {{a, a, a}, {a, -a, -a}, {-a, a, -a}, {-a, -a, a}};
  const std::uint16_t triangles[4][3] = {{0, 1, 2}, {0, 1, 3}, {0, 2, 3}, {1, 2, 3}};
  std::vector<std::uint8_t> bytes(sizeof header + sizeof vertices + sizeof triangles);
  std::memcpy(bytes.data(), &header, sizeof header);
  std::memcpy(bytes.data() + sizeof header, vertices, sizeof vertices);
  std::memcpy(bytes.data() + sizeof header + sizeof vertices, triangles, sizeof triangles);
  return bytes;
}

}  // namespace voxid::test
