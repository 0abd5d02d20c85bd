// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/library/renderer.h"

#include <gtest/gtest.h>

#include "voxid/library/sensor_model.h"
#include "voxid/library/views.h"

namespace voxid {
namespace {

/// A square of side 2 in the plane z = 0.
Mesh square() { return {{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}}; }

Placement facing(float distance_mm, float scale) {
  Placement pose;
  pose.translation = Eigen::Vector3f(0, 0, distance_mm);
  pose.scale = scale;
  return pose;
}

RayScene squareScene() {
  RayScene scene;
  scene.add(square(), Placement());
  scene.commit();
  return scene;
}

TEST(Renderer, AFrontalSquareHasItsDepthAndSize) {
  const RayScene scene = squareScene();
  const RenderedView view = render(scene, Imager(), facing(1000, 100));  // 200 mm at 1 m: 105 px
  int set = 0;
  for (const Hit& hit : view.hits) {
    if (hit.object == 0) continue;
    ++set;
    EXPECT_NEAR(hit.depth_mm, 1000, 0.01);
    EXPECT_NEAR(hit.cosine, 1, 0.02);
    EXPECT_EQ(hit.object, 1);
  }
  EXPECT_NEAR(set, 105 * 105, 3 * 105);  // within a pixel a side
}

TEST(Renderer, BothSidesAreSolid) {
  const RayScene scene = squareScene();
  Placement pose = facing(1000, 100);
  pose.rotation = Eigen::Vector3f(1, -1, -1).asDiagonal();
  EXPECT_NEAR(render(scene, Imager(), pose).hits[240 * 640 + 320].depth_mm, 1000, 0.01);
}

TEST(SensorModel, TheSameSeedGivesTheSameImageAndAnotherDoesNot) {
  const RayScene scene = squareScene();
  const Placement pose = facing(800, 100);
  const auto image = [&](std::uint64_t seed) { return observe(scene, Imager(), pose, SensorParams(), seed).depth_mm; };
  EXPECT_EQ(image(1), image(1));
  EXPECT_NE(image(1), image(2));
}

// One disparity step of 1/8 px is 2.03 mm at 0.8 m with a base of 75 mm; the noise is about half a step.
TEST(SensorModel, DepthIsRightOnAverageAndNoisyByAboutAStep) {
  const RayScene scene = squareScene();
  const std::vector<std::uint16_t> depth_mm = observe(scene, Imager(), facing(800, 100), SensorParams(), 3).depth_mm;
  double sum = 0, squares = 0;
  int set = 0;
  for (const std::uint16_t d : depth_mm) {
    if (d == 0) continue;
    ++set;
    sum += d - 800.0;
    squares += (d - 800.0) * (d - 800.0);
  }
  ASSERT_GT(set, 10000);
  EXPECT_NEAR(sum / set, 0, 0.7);
  EXPECT_GT(squares / set, 0.5);
  EXPECT_LT(squares / set, 9);
}

TEST(SensorModel, DrawnPosesKeepTheDirectionAndStayInRange) {
  const format::Direction& direction = viewDirections()[17];
  const Eigen::Vector3f to_camera =
      Eigen::Vector3f(direction.to_camera[0], direction.to_camera[1], direction.to_camera[2]).normalized();
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const Placement pose = drawPose(direction, Imager(), ViewRange(), seed);
    EXPECT_GE(pose.scale, 120);
    EXPECT_LE(pose.scale, 380);
    EXPECT_GE(pose.translation.norm(), 649);
    EXPECT_LE(pose.translation.norm(), 1151);
    EXPECT_GT((pose.rotation * to_camera).dot(-pose.translation.normalized()), 0.9999f);
  }
}

}  // namespace
}  // namespace voxid
