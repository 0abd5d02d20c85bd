// SPDX-License-Identifier: BSD-3-Clause
#include "conversions.h"

#include <sensor_msgs/image_encodings.h>
#include <sensor_msgs/point_cloud2_iterator.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "model_pose.h"
#include "voxid/core/coarse.h"

namespace voxid {
namespace {

namespace encodings = sensor_msgs::image_encodings;

// The library reads the pixels in the machine's own order; every platform that ROS runs on is little-endian.
constexpr std::uint8_t kHostIsBigEndian = 0;

std::size_t bytesPerPixel(DepthUnit unit) { return unit == DepthUnit::MillimetreU16 ? 2 : 4; }

std::string sizeText(std::uint32_t width, std::uint32_t height) {
  return std::to_string(width) + " x " + std::to_string(height);
}

std::string numberText(double number) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", number);
  return text;
}

Result<DepthUnit> unitOf(const std::string& encoding) {
  if (encoding == encodings::TYPE_16UC1 || encoding == encodings::MONO16) return DepthUnit::MillimetreU16;
  if (encoding == encodings::TYPE_32FC1) return DepthUnit::MetreF32;
  return Status::badUse("depth image has the encoding '" + encoding +
                        "', expected 16UC1 (millimetres) or 32FC1 (metres): remap depth/image_raw to a depth topic");
}

Status checkPixels(const sensor_msgs::Image& image, DepthUnit unit) {
  if (image.is_bigendian != kHostIsBigEndian)
    return Status::badUse(
        "depth image has its bytes in big-endian order, expected little-endian: let the driver swap them");
  if (image.width == 0 || image.height == 0)
    return Status::badUse("depth image of " + sizeText(image.width, image.height) + " has no pixels");
  const std::size_t row_bytes = image.width * bytesPerPixel(unit);
  if (image.step < row_bytes || image.data.size() < std::size_t{image.step} * image.height ||
      image.step % bytesPerPixel(unit))
    return Status::badUse("depth image of " + sizeText(image.width, image.height) + " has " +
                          std::to_string(image.data.size()) + " bytes in rows of " + std::to_string(image.step) +
                          ", expected rows of at least " + std::to_string(row_bytes) + ": the publisher is broken");
  return {};
}

Result<Camera> cameraOf(const sensor_msgs::CameraInfo& info, const sensor_msgs::Image& image) {
  if (info.width != image.width || info.height != image.height)
    return Status::badUse("camera_info is for " + sizeText(info.width, info.height) + ", the depth image is " +
                          sizeText(image.width, image.height) + ": calibrate the depth mode that is used");
  const Camera camera = Camera::fromPixels(info.K[0], info.K[4], info.K[2], info.K[5]);
  if (!camera.valid())
    return Status::badUse("camera_info has no usable focal length or centre (K has fx " + numberText(info.K[0]) +
                          ", fy " + numberText(info.K[4]) + ", cx " + numberText(info.K[2]) + ", cy " +
                          numberText(info.K[5]) + "): give the camera a calibration");
  return camera;
}

sensor_msgs::RegionOfInterest regionOf(const PixelBox& box) {
  sensor_msgs::RegionOfInterest region;
  region.x_offset = box.x;
  region.y_offset = box.y;
  region.width = box.width;
  region.height = box.height;
  return region;
}

Eigen::Quaterniond rotationOf(const Eigen::Matrix3f& axes) {
  return Eigen::Quaterniond(axes.cast<double>()).normalized();
}

void fillSegment(const Cluster& cluster, Segment& segment) {
  segment.id = cluster.id;
  segment.pixels.assign(cluster.pixels.begin(), cluster.pixels.end());
  segment.box = regionOf(cluster.box_px);
  segment.pose.position = pointOf(cluster.box_centre_m.cast<double>());
  segment.pose.orientation = quaternionOf(rotationOf(cluster.axes));
  segment.extents_m = vectorOf(cluster.extents_m.cast<double>());
  segment.centroid = pointOf(cluster.centroid_m.cast<double>());
  segment.truncated = cluster.truncated;
}

DroppedCluster droppedClusterOf(const LeftOut& cluster) {
  DroppedCluster message;
  message.cause = static_cast<std::uint8_t>(cluster.reason);
  message.points = cluster.pixels;
  message.box = regionOf(cluster.box_px);
  return message;
}

void fillTable(const Table& table, TablePlane* message) {
  message->normal = vectorOf(table.normal.cast<double>());
  message->distance_m = table.distance_m;
  message->outline.clear();
  for (const Eigen::Vector3f& corner : table.outline_m) message->outline.push_back(pointOf(corner.cast<double>()));
  message->inliers = table.inliers;
  message->residual_mm = table.residual_mm;
  fillShape(primitiveOf(table), &message->shape, &message->shape_pose);
}

bool hasTable(SceneStatus status) { return status == SceneStatus::Ok || status == SceneStatus::EmptyTable; }

void fillCandidate(const Alternative& alternative, const Index& index, Candidate* candidate) {
  candidate->label = index.categoryName(alternative.category);
  candidate->synset = index.categories()[alternative.category].synset;
  candidate->score = alternative.score_permille / 1000.0f;
  candidate->distance = static_cast<float>(alternative.distance);
}

/// Of an object that nothing has been compared with yet, and that has no number.
void clearAnswer(Object* object) {
  object->number = object->synset = 0;
  object->score = object->distance = object->margin = object->coarse_score = 0;
  object->view = 0;
  for (std::string* text : {&object->label, &object->coarse, &object->model}) text->clear();
  object->model_pose = ModelPose();
}

using Matrix6 = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;

std::array<double, 36> arrayOf(const Matrix6& m) {
  std::array<double, 36> values;
  Eigen::Map<Matrix6>(values.data()) = m;
  return values;
}

void transformPose(const Eigen::Isometry3d& target_from_camera, geometry_msgs::Pose* pose) {
  pose->position = pointOf(target_from_camera * eigenOf(pose->position));
  pose->orientation = quaternionOf(Eigen::Quaterniond(target_from_camera.rotation()) * eigenOf(pose->orientation));
}

void transformObject(const Eigen::Isometry3d& target_from_camera, Object* object) {
  transformPose(target_from_camera, &object->pose.pose);
  const auto covariance = covarianceOf(eigenOf(object->pose.pose.orientation), eigenOf(object->extents_m));
  std::copy(covariance.begin(), covariance.end(), object->pose.covariance.begin());
  if (object->shape.type != 0) transformPose(target_from_camera, &object->shape_pose);
  transform(target_from_camera, &object->model_pose);
  object->centroid = pointOf(target_from_camera * eigenOf(object->centroid));
}

}  // namespace

Result<DepthView> viewOf(const sensor_msgs::Image& image, const sensor_msgs::CameraInfo& info) {
  const Result<DepthUnit> unit = unitOf(image.encoding);
  if (!unit.ok()) return unit.status;
  if (Status pixels = checkPixels(image, unit.value); !pixels.ok()) return pixels;
  const Result<Camera> camera = cameraOf(info, image);
  if (!camera.ok()) return camera.status;
  DepthView view;
  view.data = image.data.data();
  view.width_px = static_cast<int>(image.width);
  view.height_px = static_cast<int>(image.height);
  view.row_bytes = image.step;
  view.unit = unit.value;
  view.camera = camera.value;
  return view;
}

geometry_msgs::Point pointOf(const Eigen::Vector3d& p) {
  geometry_msgs::Point point;
  point.x = p.x();
  point.y = p.y();
  point.z = p.z();
  return point;
}

geometry_msgs::Vector3 vectorOf(const Eigen::Vector3d& v) {
  geometry_msgs::Vector3 vector;
  vector.x = v.x();
  vector.y = v.y();
  vector.z = v.z();
  return vector;
}

Eigen::Vector3d eigenOf(const geometry_msgs::Point& p) { return {p.x, p.y, p.z}; }
Eigen::Vector3d eigenOf(const geometry_msgs::Vector3& v) { return {v.x, v.y, v.z}; }
Eigen::Quaterniond eigenOf(const geometry_msgs::Quaternion& q) { return {q.w, q.x, q.y, q.z}; }

Eigen::Isometry3d eigenOf(const geometry_msgs::Transform& t) {
  return Eigen::Translation3d(eigenOf(t.translation)) * eigenOf(t.rotation).normalized();
}

geometry_msgs::Quaternion quaternionOf(const Eigen::Quaterniond& q) {
  const double sign = q.w() < 0 ? -1 : 1;
  geometry_msgs::Quaternion quaternion;
  quaternion.x = sign * q.x();
  quaternion.y = sign * q.y();
  quaternion.z = sign * q.z();
  quaternion.w = sign * q.w();
  return quaternion;
}

void fillSegments(const Scene& scene, int width_px, int height_px, Segments* message) {
  message->status = static_cast<std::uint8_t>(scene.status);
  message->width = width_px;
  message->height = height_px;
  if (hasTable(scene.status))
    fillTable(scene.table, &message->table);
  else
    message->table = TablePlane();
  message->segments.resize(scene.clusters.size);
  for (std::size_t i = 0; i < scene.clusters.size; ++i) fillSegment(scene.clusters[i], message->segments[i]);
  message->dropped.assign(scene.dropped.begin(), scene.dropped.end());
  message->dropped_clusters.resize(scene.left_out.size);
  std::transform(scene.left_out.begin(), scene.left_out.end(), message->dropped_clusters.begin(), droppedClusterOf);
  message->valid_pixels = scene.valid_pixels;
}

bool fit(const Segments& segments, const DepthView& depth) {
  if (static_cast<int>(segments.width) != depth.width_px || static_cast<int>(segments.height) != depth.height_px)
    return false;
  const std::uint32_t pixels = segments.width * segments.height;
  for (const Segment& segment : segments.segments)
    for (const std::uint32_t pixel : segment.pixels)
      if (pixel >= pixels) return false;
  return true;
}

void fillObject(const Segment& segment, const Primitive& solid, Object* object) {
  clearAnswer(object);
  object->id = segment.id;
  object->pose.pose = segment.pose;
  object->extents_m = segment.extents_m;
  const auto covariance = covarianceOf(eigenOf(segment.pose.orientation), eigenOf(segment.extents_m));
  std::copy(covariance.begin(), covariance.end(), object->pose.covariance.begin());
  object->centroid = segment.centroid;
  object->box = segment.box;
  object->points = static_cast<std::uint32_t>(segment.pixels.size());
  object->truncated = segment.truncated;
  fillShape(solid, &object->shape, &object->shape_pose);
}

OrientedBox boxOf(const Segment& segment) {
  OrientedBox box;
  box.centre_m = eigenOf(segment.pose.position).cast<float>();
  box.axes = eigenOf(segment.pose.orientation).toRotationMatrix().cast<float>();
  box.size_m = eigenOf(segment.extents_m).cast<float>();
  return box;
}

void fillShape(const Primitive& primitive, shape_msgs::SolidPrimitive* shape, geometry_msgs::Pose* pose) {
  const Eigen::Vector3d size_m = primitive.size_m.cast<double>();
  shape->type = static_cast<std::uint8_t>(primitive.kind);
  if (primitive.kind == PrimitiveKind::Cylinder)
    shape->dimensions = {size_m.z(), size_m.x() / 2};
  else
    shape->dimensions = {size_m.x(), size_m.y(), size_m.z()};
  pose->position = pointOf(primitive.centre_m.cast<double>());
  pose->orientation = quaternionOf(rotationOf(primitive.axes));
}

void fillAnswer(const Answer& answer, const Index& index, Object* object) {
  object->alternatives.resize(static_cast<std::size_t>(answer.count));
  if (answer.count == 0) return;
  for (int i = 0; i < answer.count; ++i)
    fillCandidate(answer.alternatives[i], index, &object->alternatives[static_cast<std::size_t>(i)]);
  const Candidate& best = object->alternatives.front();
  if (answer.known) {
    object->label = best.label;
    object->synset = best.synset;
  }
  object->score = answer.score_permille / 1000.0f;
  object->distance = best.distance;
  object->margin = answer.margin_permille / 1000.0f;
  const CoarseAnswer coarse = coarseAnswer(index, answer);
  object->coarse = coarse.synset;
  object->coarse_score = coarse.score_permille / 1000.0f;
  const format::View view = index.view(answer.alternatives[0].view);
  object->model = index.modelName(view.model);
  object->view = view.direction;
}

std::array<double, 36> covarianceOf(const Eigen::Quaterniond& box_axes, const Eigen::Vector3d& extents_m) {
  constexpr double kUnknownTurn = M_PI * M_PI / 3;  // variance of an angle evenly spread over a full turn
  constexpr double kTilt = (M_PI / 180) * (M_PI / 180);
  const Eigen::Matrix3d axes = box_axes.toRotationMatrix();
  const Eigen::Vector3d position = (extents_m / 2).cwiseAbs2() / 3;
  const Eigen::Vector3d rotation(kTilt, kTilt, kUnknownTurn);
  Matrix6 covariance = Matrix6::Zero();
  covariance.topLeftCorner<3, 3>() = axes * position.asDiagonal() * axes.transpose();
  covariance.bottomRightCorner<3, 3>() = axes * rotation.asDiagonal() * axes.transpose();
  return arrayOf(covariance);
}

void transform(const Eigen::Isometry3d& target_from_camera, Objects* objects) {
  objects->table.normal = vectorOf(target_from_camera.rotation() * eigenOf(objects->table.normal));
  for (geometry_msgs::Point& corner : objects->table.outline) corner = pointOf(target_from_camera * eigenOf(corner));
  if (objects->table.shape.type != 0) transformPose(target_from_camera, &objects->table.shape_pose);
  for (Object& object : objects->objects) transformObject(target_from_camera, &object);
}

sensor_msgs::PointCloud2 cloudOf(const DepthView& depth, const Segments& segments) {
  std::size_t points = 0;
  for (const Segment& segment : segments.segments) points += segment.pixels.size();
  sensor_msgs::PointCloud2 cloud;
  cloud.header = segments.header;
  cloud.is_dense = true;
  sensor_msgs::PointCloud2Modifier modifier(cloud);
  modifier.setPointCloud2FieldsByString(2, "xyz", "rgb");
  modifier.resize(points);
  sensor_msgs::PointCloud2Iterator<float> xyz(cloud, "x");
  sensor_msgs::PointCloud2Iterator<std::uint8_t> bgr(cloud, "rgb");
  for (const Segment& segment : segments.segments) {
    const auto colour = colourOf(segment.id);
    for (const std::uint32_t pixel : segment.pixels) {
      const int u = static_cast<int>(pixel % segments.width), v = static_cast<int>(pixel / segments.width);
      const PointUm p = backProject(depth.camera, u, v, depth.depthUm(u, v));
      xyz[0] = p.x * 1e-6f, xyz[1] = p.y * 1e-6f, xyz[2] = p.z * 1e-6f;
      bgr[0] = colour[2], bgr[1] = colour[1], bgr[2] = colour[0];
      ++xyz, ++bgr;
    }
  }
  return cloud;
}

const char* statusName(std::uint8_t status) {
  if (status > static_cast<std::uint8_t>(SceneStatus::BadInput)) return "UNKNOWN";
  return nameOf(static_cast<SceneStatus>(status));
}

const char* statusText(std::uint8_t status) {
  switch (static_cast<SceneStatus>(status)) {
    case SceneStatus::Ok:
      return "objects found";
    case SceneStatus::NoDepth:
      return "no pixel lies between min_depth_mm and max_depth_mm: is the camera covered or too near?";
    case SceneStatus::NoTable:
      return "no plane with at least min_table_pixels pixels: point the camera at the table";
    case SceneStatus::EmptyTable:
      return "a table, and nothing on it";
    case SceneStatus::NoTransform:
      return "tf2 does not know the target frame at the stamp: poses stay in the camera's frame";
    case SceneStatus::NoIndex:
      return "objects found, but no index is loaded: labels are empty";
    case SceneStatus::BadInput:
      return "depth image and camera_info do not fit together";
  }
  return "unknown status";
}

std::array<std::uint8_t, 3> colourOf(int id) {
  static constexpr std::array<std::array<std::uint8_t, 3>, 8> kColours{{
      {230, 80, 60},
      {60, 160, 230},
      {90, 200, 90},
      {240, 180, 40},
      {170, 100, 220},
      {40, 200, 200},
      {240, 120, 180},
      {160, 160, 60},
  }};
  return kColours[static_cast<std::size_t>(id < 1 ? 0 : id - 1) % kColours.size()];
}

}  // namespace voxid
