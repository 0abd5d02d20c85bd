// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/core/crc32c.h"

#include <array>

namespace voxid {
namespace {

constexpr std::uint32_t kPolynomial = 0x82f63b78;  // Castagnoli's 0x1edc6f41, reflected
constexpr int kSlices = 8;
using Tables = std::array<std::array<std::uint32_t, 256>, kSlices>;

constexpr std::uint32_t shiftByte(std::uint32_t sum) {
  for (int bit = 0; bit < 8; ++bit) sum = (sum >> 1) ^ (sum & 1 ? kPolynomial : 0);
  return sum;
}

// Table k holds the sum of a byte followed by k zero bytes, so that eight bytes are looked up independently.
constexpr Tables makeTables() {
  Tables t{};
  for (std::uint32_t byte = 0; byte < 256; ++byte) {
    t[0][byte] = shiftByte(byte);
    for (int k = 1; k < kSlices; ++k) t[k][byte] = shiftByte(t[k - 1][byte]);
  }
  return t;
}
constexpr Tables kTables = makeTables();

std::uint32_t eightBytes(std::uint32_t sum, const std::uint8_t* p) {
  std::uint32_t next = 0;
  for (int i = 0; i < 4; ++i) next ^= kTables[7 - i][(p[i] ^ sum >> 8 * i) & 0xff];
  for (int i = 4; i < 8; ++i) next ^= kTables[7 - i][p[i]];
  return next;
}

}  // namespace

std::uint32_t crc32c(const void* data, std::size_t bytes, std::uint32_t sum) {
  const auto* p = static_cast<const std::uint8_t*>(data);
  sum = ~sum;
  for (; bytes >= 8; bytes -= 8, p += 8) sum = eightBytes(sum, p);
  for (; bytes > 0; --bytes, ++p) sum = (sum >> 8) ^ kTables[0][(sum ^ *p) & 0xff];
  return ~sum;
}

}  // namespace voxid
