// SPDX-License-Identifier: BSD-3-Clause
// Squared Euclidean distances between codes of profile "default".
#pragma once

#include <cstddef>
#include <cstdint>

namespace voxid {

/// From `query` to `count` codes one after another.
void squaredDistances(const std::uint8_t* query, const std::uint8_t* codes, std::size_t count, std::size_t code_bytes,
                      std::uint32_t* distances);

/// From `query` to the codes that `rows` number.
void squaredDistancesAt(const std::uint8_t* query, const std::uint8_t* codes, const std::uint32_t* rows,
                        std::size_t count, std::size_t code_bytes, std::uint32_t* distances);

/// The two numbers of a packed byte.
inline std::int8_t lowerNumber(std::uint8_t packed) { return static_cast<std::int8_t>(packed << 4); }
inline std::int8_t upperNumber(std::uint8_t packed) { return static_cast<std::int8_t>(packed & 0xf0); }

}  // namespace voxid
