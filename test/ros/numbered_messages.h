// SPDX-License-Identifier: BSD-3-Clause
// Messages for the tests of what is made of them.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "conversions.h"
#include "table_scene.h"

namespace voxid::test {

/// A wall straight before the camera, seen at 5 s, and a segment of some of its pixels.
struct WallScene {
  WallScene(std::uint16_t wall_mm, int id, std::vector<std::uint32_t> pixels)
      : image(imageOf(std::vector<std::uint16_t>(320 * 240, wall_mm), ros::Time(5))),
        depth(viewOf(*image, *infoOf(ros::Time(5))).value) {
    segments.header = image->header;
    segments.width = 320;
    segments.height = 240;
    segments.segments.resize(1);
    segments.segments[0].id = id;
    segments.segments[0].pixels = std::move(pixels);
  }

  sensor_msgs::ImagePtr image;
  DepthView depth;
  Segments segments;
};

/// No two fields alike, so that none can stand in for another.
inline ModelPose numberedModelPose() {
  ModelPose m;
  m.status = ModelPose::ALIGNED;
  m.stamp = ros::Time(1699999999, 987654000);
  m.label = "cup";
  m.model = "cup-9";
  m.pose.pose.position = pointOf({1.5, 2.5, 3.5});
  m.pose.pose.orientation = quaternionOf(Eigen::Quaterniond(0.8, 0.1, -0.5, 0.3162).normalized());
  for (int i = 0; i < 36; ++i) m.pose.covariance[i] = 100 + i;
  m.scale_m = 0.175f;
  m.scale_deviation_m = 0.004f;
  m.extents_m = vectorOf({0.11, 0.09, 0.07});
  m.fit_mm = 1.25f;
  m.explained = 0.93f;
  m.free_axis = vectorOf({0.6, 0, 0.8});
  m.symmetry[0] = 2, m.symmetry[1] = 0, m.symmetry[2] = 4;
  return m;
}

inline Object numberedObject() {
  Object o;
  o.id = 3;
  o.number = 70000;
  o.label = "mug";
  o.synset = 3797390;
  o.score = 0.87f;
  o.distance = 4321;
  o.margin = 0.25f;
  for (int i = 0; i < 10; ++i) {
    Candidate c;
    c.label = "c" + std::to_string(i);
    c.synset = 200 + i;
    c.score = 0.1f * i;
    c.distance = 100.0f * i;
    o.alternatives.push_back(c);
  }
  o.coarse = "container.n.01";
  o.coarse_score = 0.96f;
  o.model = "mug-12";
  o.view = 42;
  o.pose.pose.position = pointOf({1, 2, 3});
  o.pose.pose.orientation = quaternionOf(Eigen::Quaterniond(0.5, -0.5, 0.5, 0.5));
  for (int i = 0; i < 36; ++i) o.pose.covariance[i] = i;
  o.extents_m = vectorOf({0.1, 0.2, 0.3});
  o.shape.type = shape_msgs::SolidPrimitive::CYLINDER;
  o.shape.dimensions = {0.25, 0.0625};
  o.shape_pose.position = pointOf({1.1, 2.1, 3.1});
  o.shape_pose.orientation = quaternionOf(Eigen::Quaterniond(0.7, 0.1, 0.5, -0.5).normalized());
  o.model_pose = numberedModelPose();
  o.centroid = pointOf({4, 5, 6});
  o.box.x_offset = 10, o.box.y_offset = 20, o.box.width = 30, o.box.height = 40;
  o.points = 777;
  o.truncated = true;
  return o;
}

inline Objects numberedObjects() {
  Objects objects;
  objects.header.stamp = ros::Time(1700000000, 123456789);
  objects.header.frame_id = "base";
  objects.status = Objects::NO_INDEX;
  objects.status_text = "why";
  objects.table.normal = vectorOf({0, 0, 1});
  objects.table.distance_m = 0.7f;
  objects.table.shape.type = shape_msgs::SolidPrimitive::BOX;
  objects.table.shape.dimensions = {1.2, 0.8, 0.02};
  objects.table.shape_pose.position = pointOf({7, 8, 9});
  objects.table.shape_pose.orientation = quaternionOf(Eigen::Quaterniond(0.9, 0.2, 0.3, 0.1).normalized());
  objects.table.inliers = 45678;
  objects.table.residual_mm = 0.7f;
  objects.camera_frame = "eye";
  objects.index = "kitchen.vxi";
  objects.dropped = {5, 6, 7};
  objects.segment_ms = 2.5f;
  objects.classify_ms = 3.5f;
  objects.latency_ms = 9.5f;
  objects.table.outline = {pointOf({0, 0, 0}), pointOf({1, 0, 0}), pointOf({1, 2, 0})};
  objects.objects = {numberedObject()};
  return objects;
}

}  // namespace voxid::test
