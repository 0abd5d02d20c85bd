// SPDX-License-Identifier: BSD-3-Clause
#include "float_distance.h"

#include <array>
#include <cmath>
#include <numeric>

namespace voxid::cli {

float l1OfFloats(const float* a, const float* b, int bins) {
  constexpr int kLanes = 8;  // sums of their own, so that compilers may use vectors
  std::array<float, kLanes> sums{};
  for (int i = 0; i < bins; i += kLanes) {
    for (int lane = 0; lane < kLanes; ++lane) sums[lane] += std::abs(a[i + lane] - b[i + lane]);
  }
  return std::accumulate(sums.begin(), sums.end(), 0.0f);
}

}  // namespace voxid::cli
