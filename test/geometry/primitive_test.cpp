// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/geometry/primitive.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <numeric>
#include <vector>

#include "rendered.h"
#include "voxid/geometry/segmenter.h"

namespace voxid {
namespace {

using Eigen::Vector3f;
using test::inCamera;

/// Of the only thing on the table.
Primitive primitiveIn(const test::Image& image) {
  Segmenter segmenter;
  const Scene& scene = segmenter.segment(image.view(), {});
  if (scene.clusters.size != 1) return {};
  return primitiveOf(image.view(), scene.clusters[0].pixels, boxOf(scene.clusters[0]));
}

TEST(Primitive, OfABoxIsTheBox) {
  const test::View view;
  const Primitive found = primitiveIn(test::render(view, {{0.05, 0.7, 0.16, 0.08, 0.12, 20}}));
  EXPECT_EQ(found.kind, PrimitiveKind::Box);
  EXPECT_LT((found.centre_m.cast<double>() - inCamera(view, 0.05, 0.7, 0.06)).norm(), 0.006);
  EXPECT_NEAR(found.size_m.x(), 0.16, 0.008);
  EXPECT_NEAR(found.size_m.y(), 0.08, 0.008);
  EXPECT_NEAR(found.size_m.z(), 0.12, 0.004);
  EXPECT_LT(found.misfit_mm, 2);
}

TEST(Primitive, OfAVesselIsACylinderWithItsAxisUp) {
  const test::View view;
  const Primitive found = primitiveIn(test::render(view, {}, {{-0.1, 0.65, 0.04, 0.1}}));
  EXPECT_EQ(found.kind, PrimitiveKind::Cylinder);
  EXPECT_LT((found.centre_m.cast<double>() - inCamera(view, -0.1, 0.65, 0.05)).norm(), 0.005);
  EXPECT_NEAR(found.size_m.x(), 0.08, 0.004);
  EXPECT_EQ(found.size_m.x(), found.size_m.y());
  EXPECT_NEAR(found.size_m.z(), 0.1, 0.004);
  const Eigen::Vector3d up = inCamera(view, 0, 0, 1) - inCamera(view, 0, 0, 0);
  EXPECT_GT(found.axes.col(2).cast<double>().dot(up), 0.999);
  EXPECT_NEAR(found.axes.determinant(), 1, 1e-4);
}

/// Depth of a cylinder that lies along x, by formula; only what faces the camera is seen.
TEST(Primitive, OfALyingCylinderReachesBehindWhatIsSeen) {
  const test::View view;
  test::Image image = test::render(view, {});
  const double c = std::cos(view.pitch_deg * test::kRadian), s = std::sin(view.pitch_deg * test::kRadian);
  const double radius = 0.04, y = 0.7;
  for (int v = 0; v < view.height_px; ++v) {
    for (int u = 0; u < view.width_px; ++u) {
      const double rx = (u - 319.5) / 525, ry = (v - 239.5) / 525;
      const double along_y = c - s * ry, along_z = -s - c * ry;  // of the ray with depth 1
      const double a = along_y * along_y + along_z * along_z, b = -y * along_y + (0.6 - radius) * along_z;
      const double root = b * b - a * (y * y + (0.6 - radius) * (0.6 - radius) - radius * radius);
      const double depth = root < 0 ? 0 : (-b - std::sqrt(root)) / a;
      if (depth > 0 && std::abs(depth * rx) < 0.1)
        image.at(u, v) = static_cast<std::uint16_t>(std::lround(depth * 1000));
    }
  }
  const Primitive found = primitiveIn(image);
  EXPECT_EQ(found.kind, PrimitiveKind::Cylinder);
  EXPECT_LT((found.centre_m.cast<double>() - inCamera(view, 0, y, radius)).norm(), 0.008);
  EXPECT_NEAR(found.size_m.x(), 2 * radius, 0.008);
  EXPECT_NEAR(found.size_m.z(), 0.2, 0.006);
  EXPECT_GT(std::abs(found.axes(0, 2)), 0.99f);  // its axis is the image's x
}

TEST(Primitive, WithoutDepthIsTheBox) {
  const std::vector<std::uint16_t> nothing(16, 0);
  DepthView depth;
  depth.data = nothing.data();
  depth.width_px = depth.height_px = 4;
  depth.row_bytes = 8;
  depth.camera = Camera::fromPixels(5, 5, 2, 2);
  const std::vector<std::uint32_t> pixels{0, 5, 15};
  const OrientedBox box{{1, 2, 3}, Eigen::Matrix3f::Identity(), {4, 5, 6}};
  for (const Span<const std::uint32_t> of :
       {Span<const std::uint32_t>{pixels.data(), 3}, Span<const std::uint32_t>{}}) {
    const Primitive found = primitiveOf(depth, of, box);
    EXPECT_EQ(found.kind, PrimitiveKind::Box);
    EXPECT_EQ(found.centre_m, box.centre_m);
    EXPECT_EQ(found.size_m, box.size_m);
  }
}

/// As sanitizers watch: points as far as they can be.
TEST(Primitive, OfPointsKilometresAwayIsTheBox) {
  const test::Image image{6, 6, std::vector<std::uint16_t>(36, 1000), Camera::fromPixels(1e-4, 1e-4, 2.5, 2.5)};
  std::vector<std::uint32_t> pixels(36);
  std::iota(pixels.begin(), pixels.end(), 0u);
  const OrientedBox box{{-1000, 1000, 1}, Eigen::Matrix3f::Identity(), {0.1f, 0.1f, 0.1f}};
  const Primitive found = primitiveOf(image.view(), {pixels.data(), pixels.size()}, box);
  EXPECT_EQ(found.kind, PrimitiveKind::Box);
  EXPECT_NEAR(found.misfit_mm, 10, 1e-3);
}

std::vector<Vector3f> outlineOf(int corners, float radius_m, float depth_m) {
  std::vector<Vector3f> outline;
  for (int i = 0; i < corners; ++i) {
    const float angle = 6.2831853f * (static_cast<float>(i) + 0.5f) / static_cast<float>(corners);
    outline.push_back({radius_m * std::cos(angle), -radius_m * std::sin(angle), depth_m});
  }
  return outline;
}

TEST(TablePrimitive, IsASlabUnderThePlane) {
  const std::vector<Vector3f> corners{{-0.5f, 0.2f, 1}, {0.7f, 0.2f, 1}, {0.7f, -0.6f, 1}, {-0.5f, -0.6f, 1}};
  const Table table{{0, 0, -1}, 1, {corners.data(), corners.size()}, 0, 0};
  const Primitive slab = primitiveOf(table);
  EXPECT_EQ(slab.kind, PrimitiveKind::Box);
  EXPECT_LT((slab.centre_m - Vector3f(0.1f, -0.2f, 1 + kTableThickness_m / 2)).norm(), 1e-4f);
  EXPECT_LT((slab.size_m - Vector3f(1.2f, 0.8f, kTableThickness_m)).norm(), 1e-4f);
  EXPECT_LT((slab.axes.col(2) - table.normal).norm(), 1e-5f);
  EXPECT_NEAR(std::abs(slab.axes(0, 0)), 1, 1e-5);
}

TEST(TablePrimitive, OfARoundTableIsRound) {
  const auto corners = outlineOf(48, 0.4f, 1);
  const Table table{{0, 0, -1}, 1, {corners.data(), corners.size()}, 0, 0};
  const Primitive slab = primitiveOf(table);
  EXPECT_EQ(slab.kind, PrimitiveKind::Cylinder);
  EXPECT_NEAR(slab.size_m.x(), 0.8, 0.01);
  EXPECT_EQ(slab.size_m.z(), kTableThickness_m);
}

TEST(TablePrimitive, OfNoTableHasNoSize) { EXPECT_EQ(primitiveOf(Table()).size_m, Vector3f(0, 0, 0)); }

}  // namespace
}  // namespace voxid
