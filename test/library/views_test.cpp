// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/library/views.h"

#include <gtest/gtest.h>

#include <cmath>

namespace voxid {
namespace {

double dot(const std::int16_t (&a)[3], const std::int16_t (&b)[3]) {
  return (1.0 * a[0] * b[0] + 1.0 * a[1] * b[1] + 1.0 * a[2] * b[2]) / (32767.0 * 32767.0);
}

TEST(Views, DirectionsAreUnitVectorsWithUpAcross) {
  for (const format::Direction& d : viewDirections()) {
    EXPECT_NEAR(dot(d.to_camera, d.to_camera), 1, 1e-3);
    EXPECT_NEAR(dot(d.up, d.up), 1, 1e-3);
    EXPECT_NEAR(dot(d.to_camera, d.up), 0, 1e-3);
  }
}

// The face centres of the once subdivided icosahedron lie at least 16 degrees apart, and every direction has an
// opposite.
TEST(Views, DirectionsAreEightyAndSpreadOverTheSphere) {
  const Directions& all = viewDirections();
  for (const format::Direction& a : all) {
    double nearest = -1, opposite = 1;
    for (const format::Direction& b : all) {
      if (&a != &b) nearest = std::max(nearest, dot(a.to_camera, b.to_camera));
      opposite = std::min(opposite, dot(a.to_camera, b.to_camera));
    }
    EXPECT_LT(nearest, std::cos(16 * M_PI / 180));
    EXPECT_GT(nearest, std::cos(30 * M_PI / 180));
    EXPECT_NEAR(opposite, -1, 1e-3);
  }
}

}  // namespace
}  // namespace voxid
