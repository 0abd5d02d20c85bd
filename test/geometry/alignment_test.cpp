// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/geometry/alignment.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "geometry/solids.h"
#include "voxid/library/model_surface.h"
#include "voxid/library/renderer.h"
#include "voxid/library/sensor_model.h"
#include "voxid/library/views.h"

namespace voxid {
namespace {

using Eigen::Matrix3f;
using Eigen::Vector3f;

Span<const format::Direction> directions() { return {viewDirections().data(), viewDirections().size()}; }

struct Seen {
  DepthImage image;
  std::vector<std::uint32_t> pixels;

  ObservedObject object() const {
    ObservedObject object;
    object.depth = image.view();
    object.pixels = {pixels.data(), pixels.size()};
    return object;
  }
};

/// A noisy view of the mesh in a pose of its unit form.
Seen look(const Mesh& mesh, const Placement& pose, std::uint64_t seed = 1) {
  RayScene scene;
  scene.add(mesh, unitPlacement(mesh));
  scene.commit();
  Seen seen{observe(scene, Imager(), pose, SensorParams(), seed), {}};
  seen.pixels = seen.image.setPixels();
  return seen;
}

Placement placed(float x_deg, float y_deg, float z_deg, const Vector3f& at_mm, float diagonal_mm) {
  const float radian = 3.14159265f / 180;
  Placement pose;
  pose.rotation =
      (Eigen::AngleAxisf(z_deg * radian, Vector3f::UnitZ()) * Eigen::AngleAxisf(y_deg * radian, Vector3f::UnitY()) *
       Eigen::AngleAxisf(x_deg * radian, Vector3f::UnitX()))
          .toRotationMatrix();
  pose.translation = at_mm;
  pose.scale = diagonal_mm;
  return pose;
}

float degreesBetween(const Matrix3f& a, const Matrix3f& b) {
  return Eigen::AngleAxisf(Matrix3f(a.transpose() * b)).angle() * 180 / 3.14159265f;
}

class AnyDirection : public testing::TestWithParam<Vector3f> {};

TEST_P(AnyDirection, OfAModelWithoutSymmetryIsFoundWithItsScale) {
  const Mesh mesh = test::corner();
  const Placement truth = placed(GetParam().x(), GetParam().y(), GetParam().z(), {60, -40, 800}, 220);
  const Seen seen = look(mesh, truth);
  const AlignableModel model(surfaceOf(mesh), directions());
  Aligner aligner;
  aligner.observe(seen.object());
  const Alignment found = aligner.align(model);
  ASSERT_TRUE(found.found);
  EXPECT_LT(degreesBetween(found.pose.rotation, truth.rotation), 3);
  EXPECT_LT((found.pose.translation - truth.translation).norm(), 3);
  EXPECT_NEAR(found.pose.scale, 220, 220 * 0.02f);
  EXPECT_GT(found.explained, 0.9f);
  EXPECT_LT(found.fit_mm, 2.5f);
  EXPECT_TRUE(found.rotation_known);
}
INSTANTIATE_TEST_SUITE_P(Alignment, AnyDirection,
                         testing::Values(Vector3f(30, 20, 0), Vector3f(200, -50, 70), Vector3f(-100, 120, 200),
                                         Vector3f(75, 250, -33)));

// A face that is seen from the front fits at any size; only its outline tells which.
TEST(Alignment, ScaleOfAFlatFaceComesFromItsOutline) {
  const Mesh mesh = test::box(160, 100, 4);
  const Placement truth = placed(4, 3, 25, {0, 0, 800}, 200);
  const Seen seen = look(mesh, truth);
  const AlignableModel model(surfaceOf(mesh), directions());
  Aligner aligner;
  aligner.observe(seen.object());
  EXPECT_NEAR(aligner.align(model).pose.scale, 200, 5);
}

TEST(Alignment, ABottleMayStandTurnedByAnyAngle) {
  Mesh mesh;
  test::addCylinder(mesh, 35, 0, 120);
  test::addCylinder(mesh, 12, 120, 190);
  const Seen seen = look(mesh, placed(-150, 0, 0, {0, 0, 700}, 230));
  const AlignableModel model(surfaceOf(mesh), directions());
  Aligner aligner;
  aligner.observe(seen.object());
  const Alignment found = aligner.align(model);
  ASSERT_FALSE(found.rotation_known);
  EXPECT_GT(std::abs(found.free_axis.dot(found.pose.rotation.col(1))), 0.999f);
  const Eigen::Matrix3f rotation = found.covariance.block<3, 3>(3, 3);
  EXPECT_GT(found.free_axis.dot(rotation * found.free_axis), 3);
  const Vector3f across = found.free_axis.cross(Vector3f::UnitZ()).normalized();
  EXPECT_LT(across.dot(rotation * across), 0.01f);
}

/// On a table, seen from 35 degrees above. `handle`: low and high corner.
Alignment alignedMug(const Mesh::Vertex& low, const Mesh::Vertex& high) {
  Mesh mesh;
  test::addCylinder(mesh, 40, 0, 95);
  test::addBox(mesh, low, high);
  const Placement truth = placed(180 + 35, 0, 0, {0, 0, 700}, 140);
  const Seen seen = look(mesh, truth);
  const AlignableModel model(surfaceOf(mesh), directions());
  ObservedObject object = seen.object();
  object.support.normal = truth.rotation.col(1);
  float lowest = std::numeric_limits<float>::max();
  for (const Vector3f& p : model.surface().vertices) lowest = std::min(lowest, object.support.normal.dot(truth(p)));
  object.support.distance_mm = -lowest;
  Aligner aligner;
  aligner.observe(object);
  return aligner.align(model);
}

TEST(Alignment, AHandleBehindItsMugMayPointElsewhere) {
  const Alignment found = alignedMug({-6, 20, -70}, {6, 80, -35});
  ASSERT_TRUE(found.found);
  EXPECT_FALSE(found.rotation_known);
  EXPECT_GT(std::abs(found.free_axis.dot(found.pose.rotation.col(1))), 0.99f);
  const Matrix3f rotation = found.covariance.block<3, 3>(3, 3), place = found.covariance.block<3, 3>(0, 0);
  EXPECT_GT(found.free_axis.dot(rotation * found.free_axis), 3);
  // The box's centre lies 15 mm from the body's axis and goes round it.
  const Vector3f across = found.free_axis.cross(Vector3f::UnitX()).normalized();
  EXPECT_GT(std::sqrt(across.dot(place * across)), 7);
}

TEST(Alignment, AHandleThatIsSeenTellsTheRotation) {
  const Alignment found = alignedMug({35, 20, -6}, {70, 80, 6});
  ASSERT_TRUE(found.found);
  EXPECT_TRUE(found.rotation_known);
  const Matrix3f rotation = found.covariance.block<3, 3>(3, 3);
  EXPECT_LT(rotation.trace(), 0.01f);
}

TEST(Alignment, NothingReachesBelowTheTable) {
  const Mesh mesh = test::box(60, 120, 40);
  const Placement truth = placed(-160, 30, 0, {0, 0, 800}, 150);
  const Seen seen = look(mesh, truth);
  ObservedObject object = seen.object();
  // The table is 6 mm higher than where the box was drawn.
  object.support.normal = truth.rotation.col(1);
  const float bottom = 150 * 0.5f * 120 / std::sqrt(60.0f * 60 + 120 * 120 + 40 * 40);
  object.support.distance_mm = -object.support.normal.dot(truth.translation) + bottom - 6;
  const AlignableModel model(surfaceOf(mesh), directions());
  Aligner aligner;
  aligner.observe(object);
  const Alignment found = aligner.align(model);
  float lowest = std::numeric_limits<float>::max();
  for (const Vector3f& p : model.surface().vertices)
    lowest = std::min(lowest, object.support.normal.dot(found.pose(p)) + object.support.distance_mm);
  EXPECT_GT(lowest, -SupportPlane::kMostBelow_mm - 0.01f);
}

/// Seen without noise.
Seen lookClean(const Mesh& mesh, const Placement& pose) {
  RayScene scene;
  scene.add(mesh, unitPlacement(mesh));
  scene.commit();
  Seen seen{observeClean(scene, Imager(), pose), {}};
  seen.pixels = seen.image.setPixels();
  return seen;
}

int shiftOf(std::int32_t whole_q16, std::int32_t part_q16) {
  return static_cast<int>(std::lround((whole_q16 - part_q16) / 65536.0));
}

// What its code is compared by has to be what the camera would see.
TEST(Alignment, AModelIsDrawnInTheObjectsStead) {
  const Mesh mesh = test::corner();
  const Placement truth = placed(30, 20, 0, {60, -40, 800}, 220);
  const Seen seen = lookClean(mesh, truth);
  const AlignableModel model(surfaceOf(mesh), directions());
  Aligner aligner;
  aligner.observe(seen.object());
  const ObservedObject drawn = aligner.drawn(model, truth);
  const DepthView whole = seen.image.view();
  const int left = shiftOf(whole.camera.cx_q16, drawn.depth.camera.cx_q16),
            top = shiftOf(whole.camera.cy_q16, drawn.depth.camera.cy_q16);
  EXPECT_EQ(drawn.depth.camera.fx_q16, whole.camera.fx_q16);
  int differ = 0, inside = 0;
  for (const std::uint32_t pixel : drawn.pixels) {
    const int u = static_cast<int>(pixel) % drawn.depth.width_px, v = static_cast<int>(pixel) / drawn.depth.width_px;
    const std::int32_t off_um = drawn.depth.depthUm(u, v) - whole.depthUm(left + u, top + v);
    differ += std::abs(off_um) > 1000;
  }
  EXPECT_LT(differ, static_cast<int>(drawn.pixels.size) / 100);  // at edges
  const auto set = [&](int u, int v) { return whole.depthUm(u, v) > 0; };
  for (const std::uint32_t pixel : seen.pixels) {
    const int u = static_cast<int>(pixel % 640), v = static_cast<int>(pixel / 640);
    inside += set(u - 1, v) && set(u + 1, v) && set(u, v - 1) && set(u, v + 1);
  }
  const int outline = static_cast<int>(seen.pixels.size()) - inside;
  EXPECT_NEAR(static_cast<double>(drawn.pixels.size), inside + outline / 2, outline * 0.15);
}

TEST(Alignment, WhatHidesAModelHidesItsDrawing) {
  const Mesh mesh = test::box(160, 100, 80);
  const Placement truth = placed(30, 20, 0, {0, 0, 800}, 220);
  Seen seen = lookClean(mesh, truth);
  const AlignableModel model(surfaceOf(mesh), directions());
  Aligner aligner;
  aligner.observe(seen.object());
  const std::size_t alone = aligner.drawn(model, truth).pixels.size;
  std::vector<std::uint32_t> left;
  for (const std::uint32_t pixel : seen.pixels) {
    if (pixel % 640 < 320)
      left.push_back(pixel);
    else
      seen.image.depth_mm[pixel] = 500;
  }
  const std::size_t hidden = seen.pixels.size() - left.size();
  seen.pixels = left;
  aligner.observe(seen.object());
  EXPECT_NEAR(static_cast<double>(aligner.drawn(model, truth).pixels.size), static_cast<double>(alone - hidden),
              0.05 * static_cast<double>(hidden));
}

TEST(Alignment, TheSameTwice) {
  const Mesh mesh = test::corner();
  const Seen seen = look(mesh, placed(30, 20, 10, {0, 0, 900}, 250));
  const AlignableModel model(surfaceOf(mesh), directions());
  Aligner first, second;
  first.observe(look(mesh, placed(80, 20, 10, {0, 0, 700}, 150)).object());
  first.align(model);
  first.observe(seen.object());
  second.observe(seen.object());
  const Alignment a = first.align(model), b = second.align(model);
  EXPECT_EQ(a.pose.rotation, b.pose.rotation);
  EXPECT_EQ(a.pose.translation, b.pose.translation);
  EXPECT_EQ(a.pose.scale, b.pose.scale);
  EXPECT_EQ(a.covariance, b.covariance);
}

TEST(Alignment, NothingIsFoundOfNothing) {
  const Mesh mesh = test::corner();
  const Seen seen = look(mesh, placed(30, 20, 10, {0, 0, 900}, 250));
  const AlignableModel model(surfaceOf(mesh), directions()), nothing(ModelSurface{}, directions());
  Aligner aligner;
  EXPECT_FALSE(aligner.align(model).found) << "nothing was observed";
  ObservedObject few = seen.object();
  few.pixels.size = 19;
  aligner.observe(few);
  EXPECT_FALSE(aligner.align(model).found);
  aligner.observe(seen.object());
  EXPECT_FALSE(aligner.align(nothing).found);
  ObservedObject blind = seen.object();
  blind.depth.camera = Camera{};
  aligner.observe(blind);
  EXPECT_FALSE(aligner.align(model).found);
  EXPECT_EQ(aligner.drawn(model, {}).pixels.size, 0u);
}

}  // namespace
}  // namespace voxid
