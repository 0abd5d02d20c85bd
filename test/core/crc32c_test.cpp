// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/core/crc32c.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace voxid {
namespace {

std::uint32_t bitByBit(const std::vector<std::uint8_t>& data) {
  std::uint32_t sum = 0xffffffff;
  for (const std::uint8_t byte : data) {
    sum ^= byte;
    for (int bit = 0; bit < 8; ++bit) sum = (sum >> 1) ^ (0x82f63b78 & (0 - (sum & 1)));
  }
  return ~sum;
}

TEST(Crc32c, KnownValues) {
  EXPECT_EQ(crc32c("123456789", 9), 0xe3069283u);
  EXPECT_EQ(crc32c(nullptr, 0), 0u);
  const std::vector<std::uint8_t> zeros(32, 0), ones(32, 0xff);  // RFC 3720, B.4
  EXPECT_EQ(crc32c(zeros.data(), zeros.size()), 0x8a9136aau);
  EXPECT_EQ(crc32c(ones.data(), ones.size()), 0x62a8ab43u);
}

TEST(Crc32c, EveryLengthAndSplitAgreesWithTheDefinition) {
  std::vector<std::uint8_t> data;
  for (int length = 0; length < 67; ++length) {
    const std::uint32_t whole = crc32c(data.data(), data.size());
    EXPECT_EQ(whole, bitByBit(data)) << length;
    for (std::size_t split = 0; split <= data.size(); ++split) {
      const std::uint32_t first = crc32c(data.data(), split);
      EXPECT_EQ(crc32c(data.data() + split, data.size() - split, first), whole) << length << " at " << split;
    }
    data.push_back(static_cast<std::uint8_t>(length * 37 + 11));
  }
}

}  // namespace
}  // namespace voxid
