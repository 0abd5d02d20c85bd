// SPDX-License-Identifier: BSD-3-Clause
// A few real tables of ../shared/data, where it is there.
#include <gtest/gtest.h>

#include <filesystem>
#include <opencv2/imgcodecs.hpp>

#include "voxid/geometry/segmenter.h"

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
    DepthView view;
    view.data = depth_.data;
    view.width_px = depth_.cols;
    view.height_px = depth_.rows;
    view.row_bytes = depth_.step[0];
    view.camera = Camera::fromPixels(525, 525, 319.5, 239.5);
    return segmenter_.segment(view, SegmentParams{});
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

}  // namespace
}  // namespace voxid
