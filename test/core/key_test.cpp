// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/core/key.h"

#include <gtest/gtest.h>

#include "core/random.h"

namespace voxid {
namespace {

Key bit(int i) { return Key{1} << i; }

TEST(KeyOf, SetsTheBitOfEachSubHistogramsPeak) {
  Descriptor d{};
  d[7] = 1;   // D2 coarse, bins 0 to 7
  d[32] = 9;  // D2 fine
  d[160 + 63] = 200;
  d[224 + 8] = 3;
  d[288 + 16] = 4;
  d[352 + 40] = 5;
  EXPECT_EQ(keyOf(d), bit(0) | bit(4) | bit(27) | bit(29) | bit(38) | bit(49));
}

TEST(KeyOf, LowestBinWinsATie) {
  Descriptor d{};
  d[8] = d[24] = 5;
  EXPECT_EQ(keyOf(d), bit(1));
  d[24] = 6;
  EXPECT_EQ(keyOf(d), bit(3));
}

TEST(KeyOf, NothingFromNothing) { EXPECT_EQ(keyOf(Descriptor{}), Key{0}); }

TEST(KeyOf, StaysBelow52Bits) {
  Descriptor d{};
  d[415] = 1;
  EXPECT_EQ(keyOf(d), bit(51));
}

TEST(HammingDistance, CountsBits) {
  EXPECT_EQ(hammingDistance(0, 0), 0);
  EXPECT_EQ(hammingDistance(0, ~Key{0}), 64);
  EXPECT_EQ(hammingDistance(0b1011, 0b0110), 3);
  test::Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const Key a = Key{random.bits()} << 32 | random.bits(), b = Key{random.bits()} << 32 | random.bits();
    int bits = 0;
    for (int k = 0; k < 64; ++k) bits += ((a ^ b) >> k) & 1;
    ASSERT_EQ(hammingDistance(a, b), bits);
  }
}

}  // namespace
}  // namespace voxid
