// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/geometry/steady_solid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include "rendered.h"
#include "voxid/geometry/segmenter.h"

namespace voxid {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3f;

/// The only thing on a table, as it was segmented.
struct Seen {
  test::Image image;
  std::vector<std::uint32_t> pixels;
  OrientedBox box;

  explicit Seen(test::Image seen) : image(std::move(seen)) {
    Segmenter segmenter;
    const Scene& scene = segmenter.segment(image.view(), {});
    EXPECT_EQ(scene.clusters.size, 1u);
    if (scene.clusters.size != 1) return;
    pixels.assign(scene.clusters[0].pixels.begin(), scene.clusters[0].pixels.end());
    box = boxOf(scene.clusters[0]);
  }

  Span<const std::uint32_t> span() const { return {pixels.data(), pixels.size()}; }
  Primitive alone() const { return primitiveOf(image.view(), span(), box); }
  Primitive in(SteadySolid& solid, bool looks_for_better = true,
               const Isometry3d& pose = Isometry3d::Identity()) const {
    return solid.see(image.view(), span(), box, pose, looks_for_better);
  }
};

/// Noise in proportion to the depth, 1.5 mm at this distance.
test::Image withNoise(test::Image image, unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> noise(0, 0.0018);
  for (std::uint16_t& depth_mm : image.millimetres) {
    if (depth_mm > 0) depth_mm = static_cast<std::uint16_t>(std::lround(depth_mm / (1 + noise(generator))));
  }
  return image;
}

test::Image boxAt(double x, double y) { return test::render(test::View(), {{x, y, 0.16, 0.08, 0.12, 20}}); }

bool equal(const Primitive& a, const Primitive& b) {
  return a.kind == b.kind && a.centre_m == b.centre_m && a.axes == b.axes && a.size_m == b.size_m;
}

TEST(SteadySolid, OfAThingThatRestsStaysWhereEveryFrameAloneWouldGiveAnother) {
  const test::Image clean = test::render(test::View(), {{0.05, 0.7, 0.108, 0.03, 0.035, 20}});
  SteadySolid solid;
  int changes = 0, changes_alone = 0;
  Primitive last, last_alone;
  for (unsigned frame = 0; frame < 40; ++frame) {
    const Seen seen(withNoise(clean, frame));
    const Primitive now = seen.in(solid), alone = seen.alone();
    if (frame > 0) {
      changes += !equal(now, last);
      changes_alone += alone.kind != last_alone.kind;
    }
    last = now;
    last_alone = alone;
  }
  EXPECT_GE(changes_alone, 5) << "of kind: else nothing is tested";
  EXPECT_LE(changes, 1);
}

TEST(SteadySolid, GoesWithAThingThatMovesAtOnce) {
  SteadySolid solid;
  Seen(boxAt(0.05, 0.7)).in(solid);
  for (const double x : {0.068, 0.09, 0.2}) {
    const Seen moved(boxAt(x, 0.7));
    EXPECT_TRUE(equal(moved.in(solid, false), moved.alone())) << x;
  }
}

TEST(SteadySolid, IsAnotherWhereSomethingElseStands) {
  SteadySolid solid;
  Seen(boxAt(0.05, 0.7)).in(solid);
  const Seen can(test::render(test::View(), {}, {{0.05, 0.7, 0.04, 0.12}}));
  EXPECT_TRUE(equal(can.in(solid, false), can.alone())) << "it no longer fits, in its turn or not";
}

TEST(SteadySolid, StaysWholeBehindAHand) {
  const Seen whole(boxAt(0.05, 0.7));
  SteadySolid solid;
  const Primitive before = whole.in(solid);
  Seen part = whole;
  const int width = part.image.width_px;
  const Eigen::Vector3d middle = test::inCamera(test::View(), 0.05, 0.7, 0.12);
  const int middle_column = static_cast<int>(525 * middle.x() / middle.z() + width / 2.0);
  for (const std::uint32_t pixel : whole.pixels)
    if (static_cast<int>(pixel) % width < middle_column) part.image.millimetres[pixel] = 0;
  part = Seen(part.image);
  ASSERT_LT(part.alone().size_m.x(), 0.75f * before.size_m.x());
  for (int frame = 0; frame < 5; ++frame) EXPECT_TRUE(equal(part.in(solid), before));
}

TEST(SteadySolid, IsWhereItWasWhenTheCameraMoves) {
  const test::View from, nearer{0.55, 38};
  const std::vector<test::Box> box{{0.05, 0.7, 0.16, 0.08, 0.12, 20}};
  const auto tableFrom = [](const test::View& view) {
    Isometry3d table_from_camera = Isometry3d::Identity();
    const Eigen::Vector3d origin = test::inCamera(view, 0, 0, 0);
    Eigen::Matrix3d axes;
    axes << test::inCamera(view, 1, 0, 0) - origin, test::inCamera(view, 0, 1, 0) - origin,
        test::inCamera(view, 0, 0, 1) - origin;
    table_from_camera.linear() = axes.transpose();
    table_from_camera.translation() = -axes.transpose() * origin;
    return table_from_camera;
  };
  SteadySolid solid;
  const Primitive before = Seen(test::render(from, box)).in(solid, true, tableFrom(from));
  const Primitive now = Seen(test::render(nearer, box)).in(solid, true, tableFrom(nearer));
  EXPECT_EQ(now.size_m, before.size_m);
  const Eigen::Vector3d expected = tableFrom(nearer).inverse() * (tableFrom(from) * before.centre_m.cast<double>());
  EXPECT_LT((now.centre_m.cast<double>() - expected).norm(), 1e-6);
  EXPECT_GT((now.centre_m - before.centre_m).norm(), 0.03f) << "in the camera's frame it has moved";
}

TEST(SteadySolid, GivesWayToOneThatFitsBetter) {
  SteadySolid solid;
  const Seen box(boxAt(0.05, 0.7));
  Seen poor = box;
  poor.box.size_m *= 1.15f;  // as where foreign points were taken for its own
  const Primitive loose = poor.in(solid);
  EXPECT_TRUE(equal(box.in(solid, false), loose)) << "not its turn";
  EXPECT_TRUE(equal(box.in(solid), box.alone()));
}

TEST(SteadySolid, IsForgottenWhenCleared) {
  SteadySolid solid;
  const Seen first(withNoise(boxAt(0.05, 0.7), 1)), second(withNoise(boxAt(0.05, 0.7), 2));
  const Primitive before = first.in(solid);
  EXPECT_TRUE(equal(second.in(solid), before));
  solid.clear();
  EXPECT_FALSE(equal(second.alone(), before));
  EXPECT_TRUE(equal(second.in(solid), second.alone()));
}

}  // namespace
}  // namespace voxid
