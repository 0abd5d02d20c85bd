// SPDX-License-Identifier: BSD-3-Clause
// For users of neither PCL nor ROS: how far apart two shapes are.
#include <cstdio>
#include <vector>

#include "voxid/core/descriptor.h"

int main() {
  std::vector<voxid::PointUm> plate, ruler;
  for (int i = 0; i < 2500; ++i) {
    plate.push_back({2000 * (i % 50), 3000 * (i / 50), 800000});
    ruler.push_back({2000 * (i % 250), 3000 * (i / 250), 800000});
  }
  voxid::Describer describer;
  const voxid::Described a = describer.describe({plate.data(), plate.size()});
  const voxid::Described b = describer.describe({ruler.data(), ruler.size()});
  std::printf("%u of 106080\n", voxid::l1(a.bins.data(), b.bins.data()));
  return a.status == voxid::DescribeStatus::Ok && b.status == voxid::DescribeStatus::Ok ? 0 : 1;
}
