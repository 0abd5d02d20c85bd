// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

namespace voxid {

/// CRC-32C (Castagnoli, reflected, as in iSCSI). Continue a sum by passing the one so far; "123456789" gives
/// 0xe3069283.
std::uint32_t crc32c(const void* data, std::size_t bytes, std::uint32_t sum = 0);

}  // namespace voxid
