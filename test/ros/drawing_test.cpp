// SPDX-License-Identifier: BSD-3-Clause
#include "drawing.h"

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <utility>
#include <vector>

#include "conversions.h"
#include "numbered_messages.h"
#include "table_scene.h"

namespace voxid {
namespace {

using test::imageOf;
using test::infoOf;
using test::numberedObjects;
using test::WallScene;

TEST(Markers, BoxLabelAndOutline) {
  const Objects objects = numberedObjects();
  const auto array = markersOf(objects, {}, {});
  ASSERT_EQ(array.markers.size(), 4u);
  const auto& outline = array.markers[0];
  EXPECT_EQ(outline.type, visualization_msgs::Marker::LINE_STRIP + 0);
  ASSERT_EQ(outline.points.size(), 4u);  // closed
  EXPECT_EQ(outline.points[3].x, outline.points[0].x);
  const auto& box = array.markers[1];
  EXPECT_EQ(box.header.frame_id, "base");
  EXPECT_EQ(box.ns, "box");
  EXPECT_EQ(box.id, 3);
  EXPECT_EQ(box.type, visualization_msgs::Marker::CUBE + 0);
  EXPECT_EQ(box.pose.position.y, 2);
  EXPECT_EQ(box.pose.orientation.x, -0.5);
  EXPECT_EQ(box.scale.z, 0.3);
  EXPECT_FLOAT_EQ(box.color.r, colourOf(3)[0] / 255.0f);
  const auto& label = array.markers[2];
  EXPECT_EQ(label.ns, "label");
  EXPECT_EQ(label.type, visualization_msgs::Marker::TEXT_VIEW_FACING + 0);
  EXPECT_EQ(label.text, "mug 87 % (container?)");
}

TEST(Caption, NamesTheCoarserThingWhereTheLabelIsUnsure) {
  Object object;
  EXPECT_EQ(captionOf(object), "?");
  object.label = "mug";
  object.score = 0.45f;
  EXPECT_EQ(captionOf(object), "mug 45 %");
  object.coarse = "drinking_vessel.n.01";
  object.coarse_score = 0.8f;
  EXPECT_EQ(captionOf(object), "mug 45 % (drinking vessel?)");
  object.label.clear();
  EXPECT_EQ(captionOf(object), "drinking vessel?");
  object.label = "mug";
  object.coarse = "mug.n.04";
  EXPECT_EQ(captionOf(object), "mug 45 %") << "the same word again says nothing";
  object.coarse = "container.n.01";
  object.score = object.coarse_score;
  EXPECT_EQ(captionOf(object), "mug 80 %") << "nothing else speaks for it";
}

/// Ends of the lines of one colour, in the marker's frame.
std::vector<Eigen::Vector3d> endsOf(const visualization_msgs::Marker& marker, float r, float g, float b) {
  std::vector<Eigen::Vector3d> ends;
  for (std::size_t i = 0; i < marker.points.size(); ++i) {
    const std_msgs::ColorRGBA& c = marker.colors[i];
    if (c.r == r && c.g == g && c.b == b) ends.push_back(eigenOf(marker.points[i]));
  }
  return ends;
}

TEST(Markers, AnAlignedModelIsItsBoxWithItsAxes) {
  Objects objects = numberedObjects();
  ModelPose& model = objects.objects[0].model_pose;
  model.rotation_known = true;
  const auto marker = markersOf(objects, {}, {}).markers[3];
  EXPECT_EQ(marker.ns, "model");
  EXPECT_EQ(marker.id, 3);
  EXPECT_EQ(marker.type, visualization_msgs::Marker::LINE_LIST + 0);
  EXPECT_EQ(marker.pose, model.pose.pose);
  const auto edges = endsOf(marker, 1, 1, 1);
  ASSERT_EQ(edges.size(), 24u);
  for (const Eigen::Vector3d& end : edges)
    EXPECT_LT((end.cwiseAbs() - Eigen::Vector3d(0.055, 0.045, 0.035)).norm(), 1e-12);
  double length_m = 0;
  for (std::size_t i = 0; i < edges.size(); i += 2) length_m += (edges[i] - edges[i + 1]).norm();
  EXPECT_NEAR(length_m, 4 * (0.11 + 0.09 + 0.07), 1e-9);
  EXPECT_NEAR(endsOf(marker, 0, 1, 0)[1].y(), 0.0875, 1e-6) << "the model's y is green";

  model.rotation_known = false;
  const auto free = markersOf(objects, {}, {}).markers[3];
  EXPECT_TRUE(endsOf(free, 0, 1, 0).empty());
  const auto axis = endsOf(free, 1, 1, 0);
  ASSERT_EQ(axis.size(), 2u);
  const Eigen::Vector3d along = eigenOf(free.pose.orientation) * (axis[1] - axis[0]).normalized();
  EXPECT_LT((along - eigenOf(model.free_axis)).norm(), 1e-6);
}

/// Three corners of a unit box of the model that numberedModelPose() names, after another of the same name.
AlignedModels numberedModels() {
  AlignedModels models;
  models.models.resize(2);
  for (AlignedModel& model : models.models) model.model = "cup-9";
  models.models[0].label = "jug";
  models.models[1].label = "cup";
  models.models[0].points.resize(7);
  models.models[1].points.resize(3);
  models.models[1].points[0].x = models.models[1].points[1].y = models.models[1].points[2].z = 0.5f;
  return models;
}

TEST(Markers, TheSurfaceOfAnAlignedModelIsItsPoints) {
  Objects objects = numberedObjects();
  const auto marker = markersOf(objects, numberedModels(), {}).markers[4];
  EXPECT_EQ(marker.ns, "surface");
  EXPECT_EQ(marker.id, 3);
  EXPECT_EQ(marker.header.frame_id, "base");
  EXPECT_EQ(marker.type, visualization_msgs::Marker::POINTS + 0);
  EXPECT_EQ(marker.pose, objects.objects[0].model_pose.pose.pose);
  EXPECT_FLOAT_EQ(marker.color.g, (1 + colourOf(3)[1] / 255.0f) / 2);
  ASSERT_EQ(marker.points.size(), 3u);
  for (int i = 0; i < 3; ++i)
    EXPECT_LT((eigenOf(marker.points[i]) - 0.0875 * Eigen::Vector3d::Unit(i)).norm(), 1e-6) << "scale_m is 0.175";
}

TEST(Markers, WhatIsGoneIsDeleted) {
  const auto deleted = [](const visualization_msgs::MarkerArray& array) {
    std::set<std::string> names;
    for (const auto& m : array.markers)
      if (m.action == visualization_msgs::Marker::DELETE) names.insert(m.ns + std::to_string(m.id));
    return names;
  };
  Objects objects = numberedObjects();
  const AlignedModels models = numberedModels();
  const auto all = markersOf(objects, models, {});
  EXPECT_TRUE(deleted(markersOf(objects, models, all)).empty());
  objects.objects[0].model_pose.status = ModelPose::WAITING;  // it was moved
  const auto moved = markersOf(objects, models, all);
  EXPECT_EQ(deleted(moved), (std::set<std::string>{"model3", "surface3"}));
  objects.objects[0].id = 4;
  EXPECT_EQ(deleted(markersOf(objects, models, moved)), (std::set<std::string>{"box3", "label3"}));
  objects.objects.clear();
  objects.table = {};
  const auto gone = markersOf(objects, models, all);
  EXPECT_EQ(deleted(gone), (std::set<std::string>{"table0", "box3", "label3", "model3", "surface3"}));
  EXPECT_TRUE(markersOf(objects, models, gone).markers.empty()) << "said once";
}

TEST(Overlay, ColoursTheObjectAndNothingElse) {
  const WallScene wall(1000, 3, {100 * 320 + 150});
  const cv::Mat drawing = drawOverlay(wall.depth, wall.segments, numberedObjects());
  ASSERT_EQ(drawing.type(), CV_8UC3);
  ASSERT_EQ(drawing.size(), cv::Size(320, 240));
  const cv::Vec3b object = drawing.at<cv::Vec3b>(100, 150), beside = drawing.at<cv::Vec3b>(100, 151);
  EXPECT_EQ(beside[0], beside[1]);
  EXPECT_EQ(beside[1], beside[2]);
  EXPECT_NEAR(object[2], 0.35 * beside[2] + 0.65 * colourOf(3)[0], 1);
  EXPECT_EQ(drawing.at<cv::Vec3b>(20 + 39, 10 + 5)[1], colourOf(3)[1]);  // the box's lower edge
}

TEST(Overlay, DrawsTheTablesOutlineAndWhatWasDroppedWithTheReason) {
  const auto image = imageOf(std::vector<std::uint16_t>(320 * 240, 1000), ros::Time(5));
  const DepthView depth = viewOf(*image, *infoOf(ros::Time(5))).value;
  Segments segments;
  segments.width = 320;
  segments.height = 240;
  // Half a metre to each side at 1.05 m is 125 pixels.
  for (const auto& [x, y] : {std::pair(-0.5, -0.2), {0.5, -0.2}, {0.5, 0.2}, {-0.5, 0.2}})
    segments.table.outline.push_back(pointOf({x, y, 1.05}));
  segments.dropped_clusters.resize(1);
  segments.dropped_clusters[0].cause = 1;
  segments.dropped_clusters[0].points = 400;
  segments.dropped_clusters[0].box.x_offset = 200;
  segments.dropped_clusters[0].box.y_offset = 150;
  segments.dropped_clusters[0].box.width = 30;
  segments.dropped_clusters[0].box.height = 20;
  const cv::Mat with = drawOverlay(depth, segments, Objects());
  const cv::Mat without = drawOverlay(depth, Segments(), Objects());
  EXPECT_GT(with.at<cv::Vec3b>(120, 159 - 125 + 1)[0], 230);  // the outline's left side
  EXPECT_LT(without.at<cv::Vec3b>(120, 159 - 125 + 1)[0], 200);
  EXPECT_EQ(with.at<cv::Vec3b>(160, 200)[0], 190);  // the dropped cluster's left side
  const cv::Rect text(198, 138, 90, 10);
  EXPECT_GT(cv::norm(with(text), without(text), cv::NORM_L1), 5000);
}

}  // namespace
}  // namespace voxid
