// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/geometry/segmenter.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>
#include <string>

#include "geometry/rendered.h"
#include "voxid/geometry/heights.h"

namespace voxid {
namespace {

using test::Box;
using test::Image;
using test::render;
using test::View;

const Box kLow{-0.2, 0.65, 0.20, 0.12, 0.06, 20};
const Box kTall{0.2, 0.8, 0.10, 0.08, 0.18, -30};

SceneStatus statusOf(const DepthView& view) { return Segmenter().segment(view, SegmentParams{}).status; }

/// Everything that a scene says, as text.
std::string print(const Scene& scene) {
  std::string text = nameOf(scene.status);
  const auto add = [&](double x) { text += " " + std::to_string(x); };
  for (int i = 0; i < 3; ++i) add(scene.table.normal[i]);
  add(scene.table.distance_m);
  add(scene.table.inliers);
  add(scene.table.residual_mm);
  for (const auto& p : scene.table.outline_m) {
    for (int i = 0; i < 3; ++i) add(p[i]);
  }
  for (const Cluster& c : scene.clusters) {
    add(c.id);
    for (const std::uint32_t pixel : c.pixels) add(pixel);
    for (int i = 0; i < 3; ++i) add(c.centroid_m[i]);
    for (int i = 0; i < 3; ++i) add(c.extents_m[i]);
    for (int i = 0; i < 9; ++i) add(c.axes(i / 3, i % 3));
  }
  return text;
}

TEST(Segmenter, FindsTheTable) {
  const View view;
  const Image image = render(view, {kLow, kTall});
  Segmenter segmenter;
  const Scene& scene = segmenter.segment(image.view(), SegmentParams{});
  ASSERT_EQ(scene.status, SceneStatus::Ok);
  const Table& table = scene.table;
  EXPECT_NEAR(table.distance_m, 0.6, 0.0005);
  const Eigen::Vector3d up = test::inCamera(view, 0, 0, 1) - test::inCamera(view, 0, 0, 0);
  EXPECT_NEAR((table.normal.cast<double>() - up).norm(), 0, 0.001);
  EXPECT_LT(table.residual_mm, 0.6f);  // whole millimetres
  EXPECT_GT(table.inliers, 100000u);
}

TEST(Segmenter, OutlineIsTheVisibleTableCounterClockwise) {
  const View view;
  const Image image = render(view, {kLow});
  Segmenter segmenter;
  const Table& table = segmenter.segment(image.view(), SegmentParams{}).table;
  ASSERT_GE(table.outline_m.size, 4u);
  bool has_far_corner = false;
  Eigen::Vector3d turn = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < table.outline_m.size; ++i) {
    const Eigen::Vector3d p = table.outline_m[i].cast<double>();
    const Eigen::Vector3d q = table.outline_m[(i + 1) % table.outline_m.size].cast<double>();
    EXPECT_NEAR(table.normal.cast<double>().dot(p) + table.distance_m, 0, 1e-4);
    turn += p.cross(q);
    has_far_corner |= (p - test::inCamera(view, 0.5, 1.2, 0)).norm() < 0.01;
  }
  EXPECT_TRUE(has_far_corner);
  const double area_m2 =
      table.normal.cast<double>().dot(turn) / 2;  // positive: counter-clockwise from the camera's side
  EXPECT_GT(area_m2, 0.5);
  EXPECT_LT(area_m2, 0.9);  // the whole table, of which the camera sees a part
}

TEST(Segmenter, MeasuresTwoBoxes) {
  const View view;
  const Image image = render(view, {kLow, kTall});
  Segmenter segmenter;
  const Scene& scene = segmenter.segment(image.view(), SegmentParams{});
  ASSERT_EQ(scene.clusters.size, 2u);
  const Cluster &tall = scene.clusters[0], &low = scene.clusters[1];  // the tall one begins higher in the image
  EXPECT_EQ(tall.id, 1);
  EXPECT_EQ(low.id, 2);
  const auto expectSize = [](const Cluster& c, double length, double width, double height) {
    EXPECT_NEAR(c.extents_m.x(), length, 0.006);
    EXPECT_NEAR(c.extents_m.y(), width, 0.006);
    EXPECT_NEAR(c.extents_m.z(), height, 0.002);
  };
  expectSize(tall, 0.10, 0.08, 0.18);
  expectSize(low, 0.20, 0.12, 0.06);
  EXPECT_NEAR((low.box_centre_m.cast<double>() - test::inCamera(view, -0.2, 0.65, 0.03)).norm(), 0, 0.005);
  EXPECT_NEAR((tall.box_centre_m.cast<double>() - test::inCamera(view, 0.2, 0.8, 0.09)).norm(), 0, 0.005);
  EXPECT_FALSE(tall.truncated);
  EXPECT_FALSE(low.truncated);
}

TEST(Segmenter, AxesAreRightHandedWithTheNormalAsThird) {
  const View view;
  const Image image = render(view, {kLow});
  Segmenter segmenter;
  const Scene& scene = segmenter.segment(image.view(), SegmentParams{});
  ASSERT_EQ(scene.clusters.size, 1u);
  const Eigen::Matrix3d axes = scene.clusters[0].axes.cast<double>();
  EXPECT_NEAR((axes.transpose() * axes - Eigen::Matrix3d::Identity()).norm(), 0, 1e-5);
  EXPECT_NEAR(axes.col(0).cross(axes.col(1)).dot(axes.col(2)), 1, 1e-5);
  EXPECT_NEAR((axes.col(2) - scene.table.normal.cast<double>()).norm(), 0, 1e-5);
  const double c = std::cos(20 * test::kRadian), s = std::sin(20 * test::kRadian);
  const Eigen::Vector3d longer = test::inCamera(view, c, s, 0) - test::inCamera(view, 0, 0, 0);
  EXPECT_GT(std::abs(axes.col(0).dot(longer)), std::cos(2 * test::kRadian));
}

TEST(Segmenter, PixelsAreAscendingInsideTheirBoxAndOfOneObjectOnly) {
  const Image image = render(View{}, {kLow, kTall});
  Segmenter segmenter;
  const Scene& scene = segmenter.segment(image.view(), SegmentParams{});
  std::set<std::uint32_t> seen;
  for (const Cluster& c : scene.clusters) {
    EXPECT_TRUE(std::is_sorted(c.pixels.begin(), c.pixels.end()));
    int left = 640, right = -1, top = 480, bottom = -1;
    for (const std::uint32_t pixel : c.pixels) {
      EXPECT_TRUE(seen.insert(pixel).second);
      left = std::min(left, static_cast<int>(pixel) % 640);
      right = std::max(right, static_cast<int>(pixel) % 640);
      top = std::min(top, static_cast<int>(pixel) / 640);
      bottom = std::max(bottom, static_cast<int>(pixel) / 640);
    }
    EXPECT_EQ(c.box_px.x, left);
    EXPECT_EQ(c.box_px.y, top);
    EXPECT_EQ(c.box_px.width, right - left + 1);
    EXPECT_EQ(c.box_px.height, bottom - top + 1);
  }
}

TEST(Segmenter, NumbersObjectsByTheirFirstPixelsRimsIncluded) {
  Image image{640, 480, std::vector<std::uint16_t>(640 * 480, 1000), View{}.camera()};
  const auto fill = [&](int left, int top, std::uint16_t depth_mm) {
    for (int v = top; v < 160; ++v) {
      for (int u = left; u < left + 60; ++u) image.at(u, v) = depth_mm;
    }
  };
  fill(100, 100, 950);
  fill(300, 98, 995);  // a low edge above the other's first row
  fill(300, 102, 985);
  Segmenter segmenter;
  const Scene& scene = segmenter.segment(image.view(), SegmentParams{});
  ASSERT_EQ(scene.clusters.size, 2u);
  EXPECT_EQ(scene.clusters[0].pixels[0], 98u * 640 + 300);
  EXPECT_EQ(scene.clusters[1].pixels[0], 100u * 640 + 100);
  EXPECT_EQ(scene.clusters[1].id, 2);
}

/// How far a cluster's centroid is from the mean of its pixels' points.
double metresFromMean(const Image& image, const Cluster& cluster) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const std::uint32_t pixel : cluster.pixels) {
    const int u = static_cast<int>(pixel) % 640, v = static_cast<int>(pixel) / 640;
    const double z = image.millimetres[pixel] * 1e-3;
    sum += Eigen::Vector3d((u - 319.5) / 525 * z, (v - 239.5) / 525 * z, z);
  }
  return (cluster.centroid_m.cast<double>() - sum / static_cast<double>(cluster.pixels.size)).norm();
}

TEST(Segmenter, CentroidIsTheMeanOfTheVisiblePoints) {
  const Image image = render(View{}, {kTall});
  Segmenter segmenter;
  const Scene& scene = segmenter.segment(image.view(), SegmentParams{});
  ASSERT_EQ(scene.clusters.size, 1u);
  EXPECT_LT(metresFromMean(image, scene.clusters[0]), 2e-5);
}

TEST(Segmenter, MeasuresAFullTableFromEverySecondRow) {
  const Image image = render(
      View{}, {{-0.26, 0.75, 0.2, 0.16, 0.2, 20}, {0, 0.75, 0.2, 0.16, 0.2, 20}, {0.26, 0.75, 0.2, 0.16, 0.2, 20}});
  Segmenter segmenter;
  const Scene& scene = segmenter.segment(image.view(), SegmentParams{});
  ASSERT_EQ(scene.clusters.size, 3u);
  std::size_t pixels = 0;
  for (const Cluster& c : scene.clusters) {
    pixels += c.pixels.size;
    EXPECT_NEAR(c.extents_m.x(), 0.2, 0.006);
    EXPECT_NEAR(c.extents_m.y(), 0.16, 0.006);
    EXPECT_NEAR(c.extents_m.z(), 0.2, 0.002);
    EXPECT_LT(metresFromMean(image, c), 1e-3);
  }
  EXPECT_GE(pixels, 1u << 15);  // fewer are measured row by row
}

TEST(Segmenter, MeasuresASmallThingOnAFullTableFromEveryRow) {
  const Image image = render(View{}, {{-0.26, 0.75, 0.2, 0.16, 0.2, 20},
                                      {0, 0.75, 0.2, 0.16, 0.2, 20},
                                      {0.26, 0.75, 0.2, 0.16, 0.2, 20},
                                      {0, 0.5, 0.06, 0.03, 0.02}});
  Segmenter segmenter;
  const Scene& scene = segmenter.segment(image.view(), SegmentParams{});
  ASSERT_EQ(scene.clusters.size, 4u);
  const Cluster& small = scene.clusters[3];
  ASSERT_NEAR(small.extents_m.x(), 0.06, 0.003);
  EXPECT_LT(metresFromMean(image, small), 2e-5);
}

TEST(Segmenter, BoxesHoldTheEndsOfRowsThatAreNotMeasured) {
  Image image{640, 480, std::vector<std::uint16_t>(640 * 480, 1000), View{}.camera()};
  for (int i = 0; i < 250 * 141; ++i) image.at(150 + i % 250, 150 + i / 250) = 950;
  for (int i = 0; i < 40; ++i)
    image.at(400 + i, 150 + 71) = image.at(110 + i, 150 + 69) = 950;  // two spikes, a row high
  SegmentParams plain;
  plain.rim = plain.split = plain.join = false;
  Segmenter segmenter;
  const Scene& scene = segmenter.segment(image.view(), plain);
  ASSERT_EQ(scene.clusters.size, 1u);
  EXPECT_GE(scene.clusters[0].pixels.size, 1u << 15);
  EXPECT_NEAR(scene.clusters[0].extents_m.x(), 329 * 0.95 / 525, 0.002);
  EXPECT_NEAR(scene.clusters[0].extents_m.y(), 140 * 0.95 / 525, 0.002);
}

TEST(Segmenter, SaysThatNothingStandsOnTheTable) {
  const Image image = render(View{}, {});
  Segmenter segmenter;
  const Scene& scene = segmenter.segment(image.view(), SegmentParams{});
  EXPECT_EQ(scene.status, SceneStatus::EmptyTable);
  EXPECT_GT(scene.table.inliers, 100000u);
  EXPECT_EQ(scene.clusters.size, 0u);
}

TEST(Segmenter, TakesNoWallForATable) {
  Image image = render(View{}, {});
  // 1 / z falls downwards: the plane leans towards the camera at the top, as a wall before a camera that looks down.
  for (int v = 0; v < 480; ++v) {
    for (int u = 0; u < 640; ++u) image.at(u, v) = static_cast<std::uint16_t>(std::lround(1000 / (1.2 - 0.0012 * v)));
  }
  EXPECT_EQ(statusOf(image.view()), SceneStatus::NoTable);
  SegmentParams any;
  any.max_tilt_deg = 180;
  EXPECT_EQ(Segmenter().segment(image.view(), any).status, SceneStatus::EmptyTable);
}

TEST(Segmenter, SeesATableFromStraightAbove) {
  View above;
  above.pitch_deg = 90;
  above.near_m = -0.3;
  above.far_m = 0.3;
  const Image image = render(above, {{0, 0, 0.1, 0.06, 0.08}});
  Segmenter segmenter;
  const Scene& scene = segmenter.segment(image.view(), SegmentParams{});
  ASSERT_EQ(scene.clusters.size, 1u);
  EXPECT_NEAR(scene.clusters[0].extents_m.x(), 0.1, 0.004);
  EXPECT_NEAR(scene.clusters[0].extents_m.z(), 0.08, 0.002);
}

TEST(Segmenter, KnowsAWallFromATableWhereUpIsKnown) {
  const Image flat{640, 480, std::vector<std::uint16_t>(640 * 480, 1000), View{}.camera()};
  Segmenter segmenter;
  const auto statusWith = [&](const Eigen::Vector3f& up) {
    return segmenter.segment(flat.view(), SegmentParams{}, up).status;
  };
  EXPECT_EQ(segmenter.segment(flat.view(), SegmentParams{}).status, SceneStatus::EmptyTable);
  EXPECT_EQ(statusWith({0, -1, 0}), SceneStatus::NoTable);  // before a level camera
  EXPECT_EQ(statusWith({0, 0, -1}), SceneStatus::EmptyTable);
  EXPECT_EQ(statusWith(Eigen::Vector3f(0, -0.5f, -0.8f).normalized()), SceneStatus::NoTable);  // 32 degrees
  EXPECT_EQ(statusWith(Eigen::Vector3f(0, -0.5f, -1.0f).normalized()), SceneStatus::EmptyTable);
}

TEST(Segmenter, FindsTheTableBeforeACameraThatHangsUpsideDownWhereUpIsKnown) {
  const View view;
  Image image = render(view, {kTall});
  std::reverse(image.millimetres.begin(), image.millimetres.end());
  EXPECT_EQ(statusOf(image.view()), SceneStatus::NoTable);
  const Eigen::Vector3d upright = test::inCamera(view, 0, 0, 1) - test::inCamera(view, 0, 0, 0);
  const Eigen::Vector3f up = Eigen::Vector3d(-upright.x(), -upright.y(), upright.z()).cast<float>();
  Segmenter segmenter;
  const Scene& scene = segmenter.segment(image.view(), SegmentParams{}, up);
  ASSERT_EQ(scene.clusters.size, 1u);
  EXPECT_GT(scene.table.normal.dot(up), 0.9999f);
  EXPECT_NEAR(scene.table.distance_m, view.camera_height_m, 0.0005);
}

TEST(Segmenter, NeedsEnoughTable) {
  View small;
  small.left_m = -0.04;
  small.right_m = 0.04;
  small.far_m = 0.38;
  EXPECT_EQ(statusOf(render(small, {}).view()), SceneStatus::NoTable);
}

TEST(Segmenter, SaysThatThereIsNoDepth) {
  Image image = render(View{}, {});
  std::fill(image.millimetres.begin(), image.millimetres.end(), std::uint16_t{0});
  EXPECT_EQ(statusOf(image.view()), SceneStatus::NoDepth);
  std::fill(image.millimetres.begin(), image.millimetres.end(), std::uint16_t{65535});
  EXPECT_EQ(statusOf(image.view()), SceneStatus::NoDepth);
  const std::vector<float> nothing(image.millimetres.size(), std::numeric_limits<float>::quiet_NaN());
  EXPECT_EQ(statusOf(test::viewOf(nothing, image)), SceneStatus::NoDepth);
}

TEST(Segmenter, RefusesWhatIsNoImage) {
  const Image image = render(View{}, {});
  EXPECT_EQ(statusOf(DepthView{}), SceneStatus::BadInput);
  DepthView v = image.view();
  v.camera = Camera{};
  EXPECT_EQ(statusOf(v), SceneStatus::BadInput);
  v = image.view();
  v.row_bytes = 639 * 2;
  EXPECT_EQ(statusOf(v), SceneStatus::BadInput);
  v = image.view();
  v.width_px = 0;
  EXPECT_EQ(statusOf(v), SceneStatus::BadInput);
  v = image.view();
  v.width_px = 1 << 20;
  v.row_bytes = std::size_t{1} << 21;
  EXPECT_EQ(statusOf(v), SceneStatus::BadInput);
}

TEST(Segmenter, SurvivesTinyImages) {
  for (int width = 1; width <= 5; ++width) {
    for (int height = 1; height <= 5; ++height) {
      Image image{width, height, std::vector<std::uint16_t>(static_cast<std::size_t>(width * height), 800),
                  Camera::fromPixels(525, 525, 0, 0)};
      const SceneStatus status = statusOf(image.view());
      EXPECT_TRUE(status == SceneStatus::NoTable || status == SceneStatus::EmptyTable) << width << " x " << height;
    }
  }
}

TEST(Segmenter, SurvivesNoise) {
  Image image = render(View{}, {});
  std::uint32_t state = 1;
  for (std::uint16_t& mm : image.millimetres) {
    state = state * 1664525 + 1013904223;
    mm = static_cast<std::uint16_t>(300 + (state >> 16) % 2200);
  }
  Segmenter segmenter;
  const Scene& scene = segmenter.segment(image.view(), SegmentParams{});
  EXPECT_LE(scene.clusters.size, 64u);
  EXPECT_EQ(scene.valid_pixels, 640u * 480u);
}

/// A box of 60 x 60 pixels on a table seen from straight above; what would lie outside the image is cut off.
Image boxAt(int left, int top) {
  Image image{640, 480, std::vector<std::uint16_t>(640 * 480, 1000), View{}.camera()};
  for (int v = std::max(top, 0); v < std::min(top + 60, 480); ++v) {
    for (int u = std::max(left, 0); u < std::min(left + 60, 640); ++u) image.at(u, v) = 950;
  }
  return image;
}

TEST(Segmenter, FlagsWhatTheBorderCutsOnAnySide) {
  Segmenter segmenter;
  const auto isTruncated = [&](int left, int top) {
    const Image image = boxAt(left, top);
    const Scene& scene = segmenter.segment(image.view(), SegmentParams{});
    EXPECT_EQ(scene.clusters.size, 1u) << left << " " << top;
    return scene.clusters.size == 1 && scene.clusters[0].truncated;
  };
  EXPECT_FALSE(isTruncated(300, 200));
  EXPECT_TRUE(isTruncated(-30, 200));
  EXPECT_TRUE(isTruncated(610, 200));
  EXPECT_TRUE(isTruncated(300, -30));
  EXPECT_TRUE(isTruncated(300, 450));
}

TEST(Segmenter, KeepsAndFlagsWhatReachesOverTheOutline) {
  Image image = boxAt(300, 200);
  SegmentParams narrow;
  narrow.outline_margin_mm = 0;
  Segmenter segmenter;
  const auto cut = [&](int width_px) {  // the table ends there, the box does not
    for (int v = 0; v < 480; ++v) {
      for (int u = width_px; u < 640; ++u) image.at(u, v) = image.at(u, v) == 950 ? 950 : 0;
    }
  };
  cut(360);
  const Scene& scene = segmenter.segment(image.view(), narrow);
  ASSERT_EQ(scene.clusters.size, 1u);
  EXPECT_FALSE(scene.clusters[0].truncated);
  cut(330);  // half of it stands over the edge
  segmenter.segment(image.view(), narrow);
  ASSERT_EQ(scene.clusters.size, 1u);
  EXPECT_TRUE(scene.clusters[0].truncated);
  cut(308);
  segmenter.segment(image.view(), narrow);
  EXPECT_EQ(scene.clusters.size, 0u);
  EXPECT_EQ(scene.dropped[static_cast<std::size_t>(DropReason::OutsideOutline)], 1u);
}

TEST(Segmenter, DropsAndCountsWhatIsNoObject) {
  // A crumb, and a thing in the air beside the table.
  const Image image = render(View{}, {kTall, {-0.2, 0.7, 0.012, 0.012, 0.012}, {0.63, 1.1, 0.1, 0.1, 0.15, 0, 0.05}});
  Segmenter segmenter;
  const Scene& scene = segmenter.segment(image.view(), SegmentParams{});
  EXPECT_EQ(scene.clusters.size, 1u);
  EXPECT_GE(scene.dropped[static_cast<std::size_t>(DropReason::TooFewPoints)], 1u);
  EXPECT_EQ(scene.dropped[static_cast<std::size_t>(DropReason::OutsideOutline)], 1u);
  EXPECT_EQ(scene.dropped[static_cast<std::size_t>(DropReason::TooMany)], 0u);
  const LeftOut* in_the_air = nullptr;
  for (const LeftOut& cluster : scene.left_out) {
    if (cluster.reason == DropReason::OutsideOutline) in_the_air = &cluster;
  }
  ASSERT_NE(in_the_air, nullptr);
  EXPECT_GT(in_the_air->pixels, 200u);
  EXPECT_GT(in_the_air->box_px.x, View{}.width_px / 2);
  EXPECT_LE(in_the_air->pixels, static_cast<unsigned>(in_the_air->box_px.width * in_the_air->box_px.height));
}

TEST(Segmenter, TellsOfTheLargestOfManyThatAreLeftOut) {
  Image image{640, 480, std::vector<std::uint16_t>(640 * 480, 1000), View{}.camera()};
  for (int crumb = 0; crumb < 70; ++crumb) {  // of 10 to 79 pixels
    for (int i = 0; i < 10 + crumb; ++i) image.at(30 + crumb % 10 * 60 + i % 10, 30 + crumb / 10 * 60 + i / 10) = 950;
  }
  SegmentParams plain;
  plain.rim = plain.split = plain.join = false;
  Segmenter segmenter;
  const Scene& scene = segmenter.segment(image.view(), plain);
  EXPECT_EQ(scene.dropped[static_cast<std::size_t>(DropReason::TooFewPoints)], 70u);
  std::set<std::uint32_t> pixels;
  for (const LeftOut& cluster : scene.left_out) pixels.insert(cluster.pixels);
  ASSERT_EQ(pixels.size(), 64u);
  EXPECT_EQ(*pixels.begin(), 16u);
  EXPECT_EQ(*pixels.rbegin(), 79u);
}

TEST(Segmenter, DividesIntoTableAndAboveAsPartsAreFound) {
  const Image image = render(View{}, {kTall, kLow});
  SegmentParams plain;  // no pixel but those above
  plain.rim = plain.split = plain.join = false;
  Segmenter segmenter;
  const Scene& scene = segmenter.segment(image.view(), plain);
  TableAndAbove parts;
  divide(image.view(), scene.table, plain, parts);
  std::vector<std::uint32_t> found;
  for (const Cluster& c : scene.clusters) found.insert(found.end(), c.pixels.begin(), c.pixels.end());
  std::sort(found.begin(), found.end());
  std::vector<std::uint32_t> both;
  std::set_intersection(found.begin(), found.end(), parts.above.begin(), parts.above.end(), std::back_inserter(both));
  EXPECT_GT(both.size(), found.size() * 99 / 100);
  EXPECT_GT(both.size(), parts.above.size() * 99 / 100);
  EXPECT_NEAR(static_cast<double>(parts.table.size() + parts.above.size()), scene.valid_pixels,
              scene.valid_pixels * 0.005);
  SegmentParams wide = plain;
  wide.min_margin_per_km = 60;  // at 0.8 m some 30 mm
  const std::size_t before = parts.above.size();
  divide(image.view(), scene.table, wide, parts);
  EXPECT_LT(parts.above.size(), before);
}

TEST(Segmenter, KeepsTheLargestOfTooMany) {
  const Image image = render(View{}, {kLow, kTall, {0, 0.55, 0.04, 0.04, 0.03}});
  SegmentParams one;
  one.max_clusters = 1;
  Segmenter segmenter;
  std::size_t largest = 0;
  for (const Cluster& c : segmenter.segment(image.view(), SegmentParams{}).clusters) {
    largest = std::max(largest, c.pixels.size);
  }
  const Scene& scene = segmenter.segment(image.view(), one);
  ASSERT_EQ(scene.clusters.size, 1u);
  EXPECT_EQ(scene.clusters[0].pixels.size, largest);
  EXPECT_EQ(scene.clusters[0].id, 1);
  EXPECT_EQ(scene.dropped[static_cast<std::size_t>(DropReason::TooMany)], 2u);
  ASSERT_EQ(scene.left_out.size, 2u);
  for (const LeftOut& cluster : scene.left_out) {
    EXPECT_EQ(cluster.reason, DropReason::TooMany);
    EXPECT_LT(cluster.pixels, largest);
  }
}

TEST(Segmenter, OfTooManyEqualOnesTheLastIsLeftOut) {
  Image image{640, 480, std::vector<std::uint16_t>(640 * 480, 1000), View{}.camera()};
  for (int square = 0; square < 4; ++square) {
    for (int i = 0; i < 1600; ++i) image.at(60 + 120 * square + i % 40, 200 + i / 40) = 950;
  }
  SegmentParams two;
  two.rim = two.split = two.join = false;
  two.max_clusters = 2;
  Segmenter segmenter;
  const Scene& scene = segmenter.segment(image.view(), two);
  ASSERT_EQ(scene.clusters.size, 2u);
  EXPECT_EQ(scene.clusters[0].box_px.x, 60);
  EXPECT_EQ(scene.clusters[1].box_px.x, 180);
  ASSERT_EQ(scene.left_out.size, 2u);
  EXPECT_EQ(scene.left_out[0].box_px.x, 300);
  EXPECT_EQ(scene.left_out[1].box_px.x, 420);
}

TEST(Segmenter, FloatMetresGiveTheSameScene) {
  const Image image = render(View{}, {kLow, kTall});
  const std::vector<float> metres = test::metresOf(image);
  Segmenter segmenter;
  const std::string from_mm = print(segmenter.segment(image.view(), SegmentParams{}));
  EXPECT_EQ(print(segmenter.segment(test::viewOf(metres, image), SegmentParams{})), from_mm);
}

TEST(Segmenter, ForgetsTheFrameBefore) {
  const Image first = render(View{}, {kLow}), second = render(View{}, {kTall});
  View quarter;
  quarter.width_px = 320;
  quarter.height_px = 240;
  const Image small = render(quarter, {kLow, kTall});
  const std::string fresh = print(Segmenter().segment(second.view(), SegmentParams{}));
  Segmenter used;
  used.segment(first.view(), SegmentParams{});
  used.segment(small.view(), SegmentParams{});
  used.segment(DepthView{}, SegmentParams{});
  EXPECT_EQ(print(used.segment(second.view(), SegmentParams{})), fresh);
}

TEST(Segmenter, FindsTheSameInAQuarterOfThePixels) {
  View quarter;
  quarter.width_px = 320;
  quarter.height_px = 240;
  const Image image = render(quarter, {kLow, kTall});
  Segmenter segmenter;
  const Scene& scene = segmenter.segment(image.view(), SegmentParams{});
  ASSERT_EQ(scene.clusters.size, 2u);
  EXPECT_NEAR(scene.clusters[1].extents_m.x(), 0.20, 0.01);
  EXPECT_NEAR(scene.clusters[1].extents_m.z(), 0.06, 0.003);
}

TEST(SceneNames, AreThoseOfTheMessages) {
  EXPECT_STREQ(nameOf(SceneStatus::Ok), "OK");
  EXPECT_STREQ(nameOf(SceneStatus::NoTable), "NO_TABLE");
  EXPECT_STREQ(nameOf(SceneStatus::BadInput), "BAD_INPUT");
  EXPECT_STREQ(nameOf(DropReason::OutsideOutline), "outside_outline");
}

}  // namespace
}  // namespace voxid
