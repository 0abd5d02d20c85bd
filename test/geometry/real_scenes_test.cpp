// SPDX-License-Identifier: BSD-3-Clause
// A few real tables of ../shared/data, where it is there.
#include <gtest/gtest.h>

#include <filesystem>
#include <opencv2/imgcodecs.hpp>

#include "geometry/solids.h"
#include "voxid/geometry/alignment.h"
#include "voxid/geometry/segmenter.h"
#include "voxid/library/model_surface.h"
#include "voxid/library/views.h"

namespace voxid {
namespace {

constexpr char kFolder[] = "../shared/data/scenes/mosd/";

class RealScenes : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(kFolder)) GTEST_SKIP() << kFolder << " is not there: no real scenes";
  }

  const Scene& segment(const std::string& name) {
    depth_ = cv::imread(kFolder + name + "_depth.png", cv::IMREAD_UNCHANGED);
    labels_ = cv::imread(kFolder + name + "_labels.png", cv::IMREAD_UNCHANGED);
    return segmenter_.segment(view(), SegmentParams{});
  }

  DepthView view() const {
    DepthView view;
    view.data = depth_.data;
    view.width_px = depth_.cols;
    view.height_px = depth_.rows;
    view.row_bytes = depth_.step[0];
    view.camera = Camera::fromPixels(525, 525, 319.5, 239.5);
    return view;
  }

  /// Share of the object's labelled pixels that the scene's best cluster holds.
  double bestShare(const Scene& scene, int object) const {
    const auto points = cv::countNonZero(labels_ / 10 == object);
    int most = 0;
    for (const Cluster& cluster : scene.clusters) {
      int shared = 0;
      for (const std::uint32_t pixel : cluster.pixels) shared += labels_.ptr<std::uint16_t>()[pixel] / 10 == object;
      most = std::max(most, shared);
    }
    return static_cast<double>(most) / points;
  }

  Segmenter segmenter_;
  cv::Mat depth_, labels_;
};

TEST_F(RealScenes, TwoBoxes) {
  const Scene& scene = segment("learn0");
  ASSERT_EQ(scene.status, SceneStatus::Ok);
  EXPECT_NEAR(scene.table.distance_m, 0.59, 0.03);
  EXPECT_LT(scene.table.residual_mm, 2.5f);
  EXPECT_EQ(scene.clusters.size, 2u);
  EXPECT_GT(bestShare(scene, 2), 0.95);
  EXPECT_GT(bestShare(scene, 3), 0.95);
}

TEST_F(RealScenes, ATableThatObjectsCover) {
  const Scene& scene = segment("test59");
  ASSERT_EQ(scene.status, SceneStatus::Ok);
  EXPECT_NEAR(scene.table.distance_m, 0.59, 0.03);
  EXPECT_GE(scene.clusters.size, 8u);
}

float lowestOf(const ModelSurface& surface, const Placement& pose, const SupportPlane& support) {
  float lowest_mm = 1000;
  for (const Eigen::Vector3f& vertex : surface.vertices)
    lowest_mm = std::min(lowest_mm, support.normal.dot(pose(vertex)) + support.distance_mm);
  return lowest_mm;
}

TEST_F(RealScenes, NoAlignedModelReachesBelowTheTable) {
  const Span<const format::Direction> directions{viewDirections().data(), viewDirections().size()};
  const AlignableModel box(surfaceOf(test::box(2, 3, 1)), directions);
  const AlignableModel can(surfaceOf(test::cylinder(1, 2.5f)), directions);
  Aligner aligner;
  int aligned = 0, near = 0;
  for (const char* const name : {"learn0", "learn33", "learn40"}) {
    const Scene& scene = segment(name);
    for (const Cluster& cluster : scene.clusters) {
      ObservedObject object;
      object.depth = view();
      object.pixels = cluster.pixels;
      object.support = {scene.table.normal, scene.table.distance_m * 1000};
      aligner.observe(object);
      for (const AlignableModel* const model : {&box, &can}) {
        const Alignment found = aligner.align(*model);
        if (!found.found) continue;
        EXPECT_GE(lowestOf(model->surface(), found.pose, object.support), -SupportPlane::kMostBelow_mm - 0.01f)
            << name << ", object " << cluster.id;
        ++aligned;
        near += found.explained > 0.7f && found.fit_mm < 4;
      }
    }
  }
  EXPECT_GE(aligned, 20);
  EXPECT_GE(near, 5) << "boxes and cans among them are met";
}

}  // namespace
}  // namespace voxid
