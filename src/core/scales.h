// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

// Of the default descriptor. Without branches: loops over pairs take sixteen in step.
namespace voxid {

// 1024 cos(pi k / 64).
constexpr std::array<std::int16_t, 33> kCosines{1024, 1023, 1019, 1013, 1004, 993, 980, 964, 946, 926, 903,
                                                878,  851,  822,  792,  759,  724, 688, 650, 610, 569, 526,
                                                483,  438,  392,  345,  297,  249, 200, 150, 100, 50,  0};

constexpr int cosineOfPart(int k) {
  return k <= 32 ? kCosines[static_cast<std::size_t>(k)] : -kCosines[static_cast<std::size_t>(64 - k)];
}

constexpr std::array<std::int32_t, 2049> makeAngleParts() {
  std::array<std::int32_t, 2049> parts{};
  int part = 0;
  for (int c = 1024; c >= -1024; --c) {
    while (part < 63 && c <= cosineOfPart(part + 1)) ++part;
    parts[static_cast<std::size_t>(c + 1024)] = part;
  }
  return parts;
}
constexpr auto kAngleParts = makeAngleParts();

/// The angle of a cosine times 1024, in 64 equal parts of 180 degrees.
constexpr std::int32_t angleOf(std::int32_t cosine_q10) {
  const std::int32_t most = cosine_q10 > 1024 ? 1024 : cosine_q10;
  return kAngleParts[static_cast<std::size_t>((most < -1024 ? -1024 : most) + 1024)];
}

inline std::int32_t square(std::int32_t value) { return value * value; }

/// A distance in 1/64 of D, its square given in (D / 4096)^2 and below 2^31; the last part takes what is farther.
inline std::int32_t distanceOf(std::int32_t squared_units) {
  const std::int32_t squared = std::min(squared_units >> 12, 64 * 64 - 1);
  std::int32_t root = squared >= 32 * 32 ? 32 : 0;
  root += square(root + 16) <= squared ? 16 : 0;
  root += square(root + 8) <= squared ? 8 : 0;
  root += square(root + 4) <= squared ? 4 : 0;
  root += square(root + 2) <= squared ? 2 : 0;
  return root + (square(root + 1) <= squared);
}

}  // namespace voxid
