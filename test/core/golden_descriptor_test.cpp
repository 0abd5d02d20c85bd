// SPDX-License-Identifier: BSD-3-Clause
// The bytes of a few clouds, kept for ever: a change of any of them raises kDescriptorRevision.
// VOXID_WRITE_GOLDEN=1 writes the files instead of comparing.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>

#include "core/clouds.h"
#include "voxid/core/descriptor.h"

namespace voxid {
namespace {

std::string read(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void expectGolden(const std::string& name, const test::Cloud& cloud) {
  const std::string path = "test/data/golden/" + name + ".descriptor";
  const Described found = Describer().describe(test::spanOf(cloud));
  ASSERT_EQ(found.status, DescribeStatus::Ok);
  const std::string bytes(found.bins.begin(), found.bins.end());
  if (std::getenv("VOXID_WRITE_GOLDEN") != nullptr) std::ofstream(path, std::ios::binary) << bytes;
  const std::string expected = read(path);
  ASSERT_EQ(expected.size(), std::size_t{kDescriptorBytes}) << path;
  for (int i = 0; i < kDescriptorBytes; ++i) {
    ASSERT_EQ(int{found.bins[i]}, int{static_cast<std::uint8_t>(expected[i])}) << "bin " << i << " of " << path;
  }
}

TEST(GoldenDescriptor, SphereCap) { expectGolden("sphere_cap", test::sphereCap()); }
TEST(GoldenDescriptor, BoxCorner) { expectGolden("box_corner", test::boxCorner()); }
TEST(GoldenDescriptor, Mug) { expectGolden("mug", test::mug()); }
TEST(GoldenDescriptor, Ruler) { expectGolden("ruler", test::ruler()); }

}  // namespace
}  // namespace voxid
