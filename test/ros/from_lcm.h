// SPDX-License-Identifier: BSD-3-Clause
// A planner's way back from LCM to ROS, written from voxid.lcm alone.
#pragma once

#include <voxid/Objects.h>

#include <voxid/object_list_t.hpp>

namespace voxid::test {

inline ros::Time timeOf(std::int64_t utime) {
  return ros::Time(static_cast<std::uint32_t>(utime / 1000000), static_cast<std::uint32_t>(utime % 1000000 * 1000));
}

template <typename Point>
void setXyz(const double* xyz, Point& point) {
  point.x = xyz[0], point.y = xyz[1], point.z = xyz[2];
}

template <typename In>
geometry_msgs::Pose poseOf(const In& in) {
  geometry_msgs::Pose pose;
  setXyz(in.position_m, pose.position);
  pose.orientation.w = in.quat_wxyz[0];
  pose.orientation.x = in.quat_wxyz[1];
  pose.orientation.y = in.quat_wxyz[2];
  pose.orientation.z = in.quat_wxyz[3];
  return pose;
}

/// Rotation first becomes position first.
template <typename In>
geometry_msgs::PoseWithCovariance poseWithCovarianceOf(const In& in) {
  geometry_msgs::PoseWithCovariance pose;
  pose.pose = poseOf(in);
  for (int row = 0; row < 6; ++row)
    for (int column = 0; column < 6; ++column)
      pose.covariance[6 * row + column] =
          in.covariance[6 * (row < 3 ? row + 3 : row - 3) + (column < 3 ? column + 3 : column - 3)];
  return pose;
}

inline shape_msgs::SolidPrimitive shapeOf(const solid_t& in) {
  shape_msgs::SolidPrimitive shape;
  shape.type = static_cast<std::uint8_t>(in.type);
  if (in.type == solid_t::BOX + 0) shape.dimensions = {in.size_m[0], in.size_m[1], in.size_m[2]};
  if (in.type == solid_t::CYLINDER + 0) shape.dimensions = {in.size_m[2], in.size_m[0] / 2};
  return shape;
}

inline ModelPose modelPoseOf(const model_pose_t& in) {
  ModelPose out;
  out.status = static_cast<std::uint8_t>(in.status);
  out.stamp = timeOf(in.utime);
  out.label = in.label;
  out.model = in.model;
  out.pose = poseWithCovarianceOf(in);
  out.scale_m = in.scale_m;
  out.scale_deviation_m = in.scale_deviation_m;
  setXyz(in.extents_m, out.extents_m);
  out.fit_mm = in.fit_mm;
  out.explained = in.explained;
  out.rotation_known = in.rotation_known;
  setXyz(in.free_axis, out.free_axis);
  for (std::size_t i = 0; i < 3; ++i) out.symmetry[i] = static_cast<std::uint8_t>(in.symmetry[i]);
  return out;
}

inline Object objectOf(const object_t& in) {
  Object out;
  out.id = static_cast<std::uint16_t>(in.id);
  out.number = static_cast<std::uint32_t>(in.number);
  out.label = in.label;
  out.synset = static_cast<std::uint32_t>(in.synset);
  out.score = in.score;
  out.distance = in.distance;
  out.margin = in.margin;
  for (const alternative_t& alternative : in.alternatives) {
    Candidate candidate;
    candidate.label = alternative.label;
    candidate.synset = static_cast<std::uint32_t>(alternative.synset);
    candidate.score = alternative.score;
    candidate.distance = alternative.distance;
    out.alternatives.push_back(candidate);
  }
  out.coarse = in.coarse;
  out.coarse_score = in.coarse_score;
  out.model = in.model;
  out.view = static_cast<std::uint16_t>(in.view);
  out.pose = poseWithCovarianceOf(in);
  setXyz(in.extents_m, out.extents_m);
  out.shape = shapeOf(in.shape);
  out.shape_pose = poseOf(in.shape);
  out.model_pose = modelPoseOf(in.model_pose);
  setXyz(in.centroid_m, out.centroid);
  out.box.x_offset = static_cast<std::uint32_t>(in.box_px[0]);
  out.box.y_offset = static_cast<std::uint32_t>(in.box_px[1]);
  out.box.width = static_cast<std::uint32_t>(in.box_px[2]);
  out.box.height = static_cast<std::uint32_t>(in.box_px[3]);
  out.points = static_cast<std::uint32_t>(in.num_points);
  out.truncated = in.truncated;
  return out;
}

inline Objects objectsOf(const object_list_t& in) {
  Objects out;
  out.header.stamp = timeOf(in.utime);
  out.header.frame_id = in.frame_name;
  out.status = static_cast<std::uint8_t>(in.status);
  out.status_text = in.status_text;
  out.camera_frame = in.camera_frame;
  setXyz(in.table_normal, out.table.normal);
  out.table.distance_m = static_cast<float>(in.table_distance_m);
  for (const auto& corner : in.outline_m) {
    geometry_msgs::Point point;
    setXyz(corner.data(), point);
    out.table.outline.push_back(point);
  }
  out.table.inliers = static_cast<std::uint32_t>(in.table_inliers);
  out.table.residual_mm = in.table_residual_mm;
  out.table.shape = shapeOf(in.table_shape);
  out.table.shape_pose = poseOf(in.table_shape);
  for (const object_t& object : in.objects) out.objects.push_back(objectOf(object));
  out.index = in.index;
  out.dropped.assign(in.dropped.begin(), in.dropped.end());
  out.segment_ms = in.segment_ms;
  out.classify_ms = in.classify_ms;
  out.latency_ms = in.latency_ms;
  return out;
}

}  // namespace voxid::test
