// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "conversions.h"

namespace voxid {
namespace {

constexpr std::size_t kMaxObjects = 64, kMaxAlternatives = 5, kMaxOutline = 128;

void copyTo(double* out, const geometry_msgs::Point& p) { out[0] = p.x, out[1] = p.y, out[2] = p.z; }
void copyTo(double* out, const geometry_msgs::Vector3& v) { out[0] = v.x, out[1] = v.y, out[2] = v.z; }

void setAlternatives(const Object& object, std::size_t most, object_t* out) {
  out->alternatives.resize(std::min(object.alternatives.size(), most));
  out->num_alternatives = static_cast<int>(out->alternatives.size());
  for (std::size_t i = 0; i < out->alternatives.size(); ++i) {
    out->alternatives[i].label = object.alternatives[i].label;
    out->alternatives[i].synset = static_cast<int>(object.alternatives[i].synset);
    out->alternatives[i].score = object.alternatives[i].score;
    out->alternatives[i].distance = object.alternatives[i].distance;
  }
}

/// Of any type with position_m and quat_wxyz.
template <typename Out>
void setPose(const geometry_msgs::Pose& pose, Out* out) {
  copyTo(out->position_m, pose.position);
  const geometry_msgs::Quaternion& q = pose.orientation;
  out->quat_wxyz[0] = q.w, out->quat_wxyz[1] = q.x, out->quat_wxyz[2] = q.y, out->quat_wxyz[3] = q.z;
}

template <typename Out>
void setPose(const geometry_msgs::PoseWithCovariance& pose, Out* out) {
  setPose(pose.pose, out);
  std::array<double, 36> covariance;
  std::copy(pose.covariance.begin(), pose.covariance.end(), covariance.begin());
  covariance = swapHalves(covariance);
  std::copy(covariance.begin(), covariance.end(), out->covariance);
}

solid_t solidOf(const shape_msgs::SolidPrimitive& shape, const geometry_msgs::Pose& pose) {
  using shape_msgs::SolidPrimitive;
  solid_t out{};
  out.type = static_cast<std::int8_t>(shape.type);
  if (shape.type == SolidPrimitive::BOX && shape.dimensions.size() == 3)
    std::copy(shape.dimensions.begin(), shape.dimensions.end(), out.size_m);
  if (shape.type == SolidPrimitive::CYLINDER && shape.dimensions.size() == 2) {
    out.size_m[0] = out.size_m[1] = 2 * shape.dimensions[SolidPrimitive::CYLINDER_RADIUS];
    out.size_m[2] = shape.dimensions[SolidPrimitive::CYLINDER_HEIGHT];
  }
  setPose(pose, &out);
  return out;
}

model_pose_t modelPoseOf(const ModelPose& pose) {
  model_pose_t out{};
  out.status = static_cast<std::int8_t>(pose.status);
  out.utime = microsecondsOf(pose.stamp);
  out.label = pose.label;
  out.model = pose.model;
  setPose(pose.pose, &out);
  out.scale_m = pose.scale_m;
  out.scale_deviation_m = pose.scale_deviation_m;
  copyTo(out.extents_m, pose.extents_m);
  out.fit_mm = pose.fit_mm;
  out.explained = pose.explained;
  out.rotation_known = pose.rotation_known;
  copyTo(out.free_axis, pose.free_axis);
  std::copy(pose.symmetry.begin(), pose.symmetry.end(), out.symmetry);
  return out;
}

void setBox(const sensor_msgs::RegionOfInterest& box, object_t* out) {
  out->box_px[0] = static_cast<int>(box.x_offset);
  out->box_px[1] = static_cast<int>(box.y_offset);
  out->box_px[2] = static_cast<int>(box.width);
  out->box_px[3] = static_cast<int>(box.height);
}

object_t toLcm(const Object& object) {
  object_t out{};
  out.id = object.id;
  out.number = static_cast<std::int32_t>(object.number);
  out.label = object.label;
  out.synset = static_cast<int>(object.synset);
  out.score = object.score;
  out.distance = object.distance;
  out.margin = object.margin;
  setAlternatives(object, kMaxAlternatives, &out);
  out.coarse = object.coarse;
  out.coarse_score = object.coarse_score;
  out.model = object.model;
  out.view = object.view;
  setPose(object.pose, &out);
  copyTo(out.extents_m, object.extents_m);
  out.shape = solidOf(object.shape, object.shape_pose);
  out.model_pose = modelPoseOf(object.model_pose);
  copyTo(out.centroid_m, object.centroid);
  setBox(object.box, &out);
  out.num_points = static_cast<int>(object.points);
  out.truncated = object.truncated;
  return out;
}

// A hull of more corners than fit is thinned evenly; a subset of a convex hull's corners is convex too.
void setOutline(const std::vector<geometry_msgs::Point>& outline, object_list_t* out) {
  const std::size_t corners = std::min(outline.size(), kMaxOutline);
  for (std::size_t i = 0; i < corners; ++i) {
    const geometry_msgs::Point& p = outline[i * outline.size() / corners];
    out->outline_m.push_back({p.x, p.y, p.z});
  }
  out->num_outline = static_cast<int>(corners);
}

void setObjects(const Objects& objects, std::size_t most_objects, std::size_t most_alternatives, object_list_t* out) {
  out->objects.clear();
  for (std::size_t i = 0; i < std::min(objects.objects.size(), most_objects); ++i) {
    out->objects.push_back(toLcm(objects.objects[i]));
    setAlternatives(objects.objects[i], most_alternatives, &out->objects.back());
  }
  out->num_objects = static_cast<int>(out->objects.size());
}

bool fits(const object_list_t& list) { return list.getEncodedSize() <= kMaxLcmBytes; }

}  // namespace

std::array<double, 36> swapHalves(const std::array<double, 36>& covariance) {
  std::array<double, 36> swapped;
  for (int row = 0; row < 6; ++row)
    for (int column = 0; column < 6; ++column)
      swapped[6 * ((row + 3) % 6) + (column + 3) % 6] = covariance[6 * row + column];
  return swapped;
}

std::int64_t microsecondsOf(const ros::Time& stamp) { return std::int64_t{stamp.sec} * 1000000 + stamp.nsec / 1000; }

object_points_t pointsOf(const DepthView& depth, const Segments& segments, const Segment& segment,
                         std::uint32_t number) {
  object_points_t out{};
  out.utime = microsecondsOf(segments.header.stamp);
  out.frame_name = segments.header.frame_id;
  out.id = segment.id;
  out.number = static_cast<int>(number);
  const std::size_t count = std::min(segment.pixels.size(), kMaxLcmPoints);
  const auto mm = [](std::int32_t um) { return static_cast<std::int16_t>(std::clamp(um / 1000, -32767, 32767)); };
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t pixel = segment.pixels[i * segment.pixels.size() / count];
    const int u = static_cast<int>(pixel % segments.width), v = static_cast<int>(pixel / segments.width);
    const PointUm p = backProject(depth.camera, u, v, depth.depthUm(u, v));
    out.xyz_mm.push_back({mm(p.x), mm(p.y), mm(p.z)});
  }
  out.num_points = static_cast<int>(count);
  return out;
}

object_list_t toLcm(const Objects& objects) {
  object_list_t list{};
  list.utime = microsecondsOf(objects.header.stamp);
  list.frame_name = objects.header.frame_id;
  list.status = static_cast<std::int8_t>(objects.status);
  list.status_text = objects.status_text;
  copyTo(list.table_normal, objects.table.normal);
  list.table_distance_m = objects.table.distance_m;
  setOutline(objects.table.outline, &list);
  list.table_inliers = static_cast<int>(objects.table.inliers);
  list.table_residual_mm = objects.table.residual_mm;
  list.table_shape = solidOf(objects.table.shape, objects.table.shape_pose);
  list.camera_frame = objects.camera_frame;
  list.index = objects.index;
  list.dropped.assign(objects.dropped.begin(), objects.dropped.end());
  list.num_dropped = static_cast<int>(list.dropped.size());
  list.segment_ms = objects.segment_ms;
  list.classify_ms = objects.classify_ms;
  list.latency_ms = objects.latency_ms;
  setObjects(objects, kMaxObjects, kMaxAlternatives, &list);
  for (std::size_t most = kMaxAlternatives; !fits(list) && most > 0; --most)
    setObjects(objects, kMaxObjects, most - 1, &list);
  for (std::size_t most = list.objects.size(); !fits(list) && most > 0; --most) setObjects(objects, most - 1, 0, &list);
  return list;
}

}  // namespace voxid
