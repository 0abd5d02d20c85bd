// SPDX-License-Identifier: BSD-3-Clause
// Squared Euclidean distances between codes of profile "default".
#pragma once

#include <cstddef>
#include <cstdint>

#include "voxid/core/code.h"

namespace voxid {

/// From `query` to `count` codes one after another.
void squaredDistances(const std::uint8_t* query, const std::uint8_t* codes, std::size_t count, std::size_t code_bytes,
                      std::uint32_t* distances);

/// From `query` to the codes that `rows` number.
void squaredDistancesAt(const std::uint8_t* query, const std::uint8_t* codes, const std::uint32_t* rows,
                        std::size_t count, std::size_t code_bytes, std::uint32_t* distances);

/// From a projection's numbers to `count` rows of kCodeNumbers.
void squaredDistances(const CodeNumbers& query, const std::int8_t* rows, std::size_t count, std::uint32_t* distances);

/// A packed number is so many steps, -7 to 7, and kept as 8 more.
constexpr int kPackedStep = 16, kMostSteps = 7, kStepBias = 8;

}  // namespace voxid
