// SPDX-License-Identifier: BSD-3-Clause
#include "drawing.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <opencv2/imgproc.hpp>

#include "conversions.h"
#include "voxid/core/coarse.h"

namespace voxid {
namespace {

using visualization_msgs::Marker;

constexpr std::int32_t kNear_um = 300000, kFar_um = 3000000;  // of the grey scale
constexpr double kThinnest_m = 0.001;                         // rviz refuses a box without thickness
constexpr double kTextHeight_m = 0.03;
constexpr double kLine_m = 0.004;
constexpr double kPoint_m = 0.003;

cv::Vec3b bgrOf(int id) {
  const auto rgb = colourOf(id);
  return {rgb[2], rgb[1], rgb[0]};
}

// Even steps of inverse depth are even steps of grey: the table's slope shows near and far alike. Black: no depth.
std::uint8_t greyOf(std::int32_t depth_um) {
  if (depth_um <= 0) return 0;
  const double nearness = 1.0 / std::clamp(depth_um, kNear_um, kFar_um), nearest = 1.0 / kNear_um,
               farthest = 1.0 / kFar_um;
  return static_cast<std::uint8_t>(40 + 200 * std::sqrt((nearness - farthest) / (nearest - farthest)));
}

cv::Mat greyImage(const DepthView& depth) {
  cv::Mat image(depth.height_px, depth.width_px, CV_8UC3);
  for (int v = 0; v < image.rows; ++v)
    for (int u = 0; u < image.cols; ++u) image.at<cv::Vec3b>(v, u) = cv::Vec3b::all(greyOf(depth.depthUm(u, v)));
  return image;
}

void tint(const Segment& segment, cv::Mat* image) {
  const cv::Vec3b colour = bgrOf(segment.id);
  for (const std::uint32_t pixel : segment.pixels) {
    cv::Vec3b& there =
        image->at<cv::Vec3b>(static_cast<int>(pixel) / image->cols, static_cast<int>(pixel) % image->cols);
    for (int c = 0; c < 3; ++c) there[c] = cv::saturate_cast<std::uint8_t>(there[c] * 0.35 + colour[c] * 0.65);
  }
}

void write(const std::string& text, cv::Point at, double size, cv::Mat* image) {
  cv::putText(*image, text, at, cv::FONT_HERSHEY_SIMPLEX, size, cv::Scalar::all(0), 3, cv::LINE_AA);
  cv::putText(*image, text, at, cv::FONT_HERSHEY_SIMPLEX, size, cv::Scalar::all(255), 1, cv::LINE_AA);
}

cv::Point pixelOf(const Camera& camera, const geometry_msgs::Point& point_m) {
  constexpr double kPixel = 1.0 / 65536;
  return {static_cast<int>(std::lround((camera.fx_q16 * point_m.x / point_m.z + camera.cx_q16) * kPixel)),
          static_cast<int>(std::lround((camera.fy_q16 * point_m.y / point_m.z + camera.cy_q16) * kPixel))};
}

void drawOutline(const Camera& camera, const TablePlane& table, cv::Mat* image) {
  std::vector<cv::Point> corners;
  for (const geometry_msgs::Point& corner : table.outline) corners.push_back(pixelOf(camera, corner));
  if (!corners.empty()) cv::polylines(*image, corners, true, cv::Scalar::all(255), 1, cv::LINE_AA);
}

/// A cluster that is no object, and why.
void drawDropped(const DroppedCluster& cluster, cv::Mat* image) {
  if (cluster.cause >= static_cast<std::uint8_t>(DropReason::kCount)) return;  // of a later version
  const cv::Rect box(cluster.box.x_offset, cluster.box.y_offset, cluster.box.width, cluster.box.height);
  cv::rectangle(*image, box, cv::Scalar::all(190), 1);
  constexpr std::uint32_t kWorthWords = 30;  // points; crumbs would hide the picture behind their captions
  if (cluster.points < kWorthWords) return;
  std::string reason = nameOf(static_cast<DropReason>(cluster.cause));
  std::replace(reason.begin(), reason.end(), '_', ' ');
  write(reason, {box.x, std::max(box.y - 3, 10)}, image->cols / 1800.0, image);
}

void drawObject(const Object& object, cv::Mat* image) {
  const cv::Rect box(object.box.x_offset, object.box.y_offset, object.box.width, object.box.height);
  cv::rectangle(*image, box, cv::Scalar(bgrOf(object.id)), 1);
  const double size = image->cols / 1280.0;
  write(captionOf(object), {box.x, std::max(box.y - 4, static_cast<int>(24 * size))}, size, image);
}

Marker marker(const Objects& objects, const char* ns, int id, int type) {
  Marker m;
  m.header = objects.header;
  m.ns = ns;
  m.id = id;
  m.type = type;
  m.action = Marker::ADD;
  m.pose.orientation.w = 1;
  return m;
}

Marker deletion(const Objects& objects, const char* ns, int id) {
  Marker m = marker(objects, ns, id, Marker::CUBE);
  m.action = Marker::DELETE;
  return m;
}

void colour(int id, float alpha, Marker* m) {
  const auto rgb = colourOf(id);
  m->color.r = rgb[0] / 255.0f;
  m->color.g = rgb[1] / 255.0f;
  m->color.b = rgb[2] / 255.0f;
  m->color.a = alpha;
}

Marker boxOf(const Objects& objects, const Object& object) {
  Marker m = marker(objects, "box", object.id, Marker::CUBE);
  m.pose = object.pose.pose;
  m.scale.x = std::max(object.extents_m.x, kThinnest_m);
  m.scale.y = std::max(object.extents_m.y, kThinnest_m);
  m.scale.z = std::max(object.extents_m.z, kThinnest_m);
  colour(object.id, 0.4f, &m);
  return m;
}

// Above the box, along the table's normal.
Marker captionMarker(const Objects& objects, const Object& object) {
  Marker m = marker(objects, "label", object.id, Marker::TEXT_VIEW_FACING);
  const Eigen::Vector3d up = eigenOf(object.pose.pose.orientation) * Eigen::Vector3d::UnitZ();
  m.pose.position = pointOf(eigenOf(object.pose.pose.position) + up * (object.extents_m.z / 2 + kTextHeight_m));
  m.scale.z = kTextHeight_m;
  m.text = captionOf(object);
  m.color.r = m.color.g = m.color.b = m.color.a = 1;
  return m;
}

Marker outlineOf(const Objects& objects) {
  Marker m = marker(objects, "table", 0, Marker::LINE_STRIP);
  m.points = objects.table.outline;
  m.points.push_back(m.points.front());
  m.scale.x = kLine_m;
  m.color.g = m.color.a = 1;
  m.color.r = m.color.b = 0.4f;
  return m;
}

std_msgs::ColorRGBA colourOf(const Eigen::Vector3d& rgb) {
  std_msgs::ColorRGBA colour;
  colour.r = static_cast<float>(rgb.x());
  colour.g = static_cast<float>(rgb.y());
  colour.b = static_cast<float>(rgb.z());
  colour.a = 1;
  return colour;
}

void addLine(const Eigen::Vector3d& from, const Eigen::Vector3d& to, const Eigen::Vector3d& rgb, Marker* m) {
  m->points.push_back(pointOf(from));
  m->points.push_back(pointOf(to));
  m->colors.insert(m->colors.end(), 2, colourOf(rgb));
}

/// The twelve edges: from each corner along each axis on whose lower side it lies.
void addBoxEdges(const Eigen::Vector3d& half_m, const Eigen::Vector3d& rgb, Marker* m) {
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d signs(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
    for (int axis = 0; axis < 3; ++axis) {
      if (signs[axis] > 0) continue;
      Eigen::Vector3d other = signs;
      other[axis] = 1;
      addLine(signs.cwiseProduct(half_m), other.cwiseProduct(half_m), rgb, m);
    }
  }
}

void addAxes(const ModelPose& model, double half_m, Marker* m) {
  if (!model.rotation_known) {
    const Eigen::Vector3d axis = eigenOf(model.pose.pose.orientation).conjugate() * eigenOf(model.free_axis) * half_m;
    addLine(-axis, axis, {1, 1, 0}, m);
    return;
  }
  for (int i = 0; i < 3; ++i) addLine({0, 0, 0}, half_m * Eigen::Vector3d::Unit(i), Eigen::Vector3d::Unit(i), m);
}

Marker modelOf(const Objects& objects, const Object& object) {
  const ModelPose& model = object.model_pose;
  Marker m = marker(objects, "model", object.id, Marker::LINE_LIST);
  m.pose = model.pose.pose;
  m.scale.x = kLine_m / 2;
  m.color.a = 1;
  addBoxEdges(eigenOf(model.extents_m) / 2, {1, 1, 1}, &m);
  addAxes(model, static_cast<double>(model.scale_m) / 2, &m);
  return m;
}

/// Null if it is not among them.
const AlignedModel* find(const AlignedModels& models, const ModelPose& pose) {
  const auto found = std::find_if(models.models.begin(), models.models.end(), [&](const AlignedModel& model) {
    return model.label == pose.label && model.model == pose.model;
  });
  return found == models.models.end() ? nullptr : &*found;
}

/// In a lighter shade, as it lies among the object's points, which rviz has in the object's colour.
Marker surfaceOf(const Objects& objects, const Object& object, const AlignedModel& model) {
  Marker m = marker(objects, "surface", object.id, Marker::POINTS);
  m.pose = object.model_pose.pose.pose;
  m.scale.x = m.scale.y = kPoint_m;
  colour(object.id, 1, &m);
  for (float* const c : {&m.color.r, &m.color.g, &m.color.b}) *c = (1 + *c) / 2;
  const auto scale_m = static_cast<double>(object.model_pose.scale_m);
  for (const geometry_msgs::Point32& p : model.points)
    m.points.push_back(pointOf(scale_m * Eigen::Vector3d(p.x, p.y, p.z)));
  return m;
}

bool isThere(const Marker& wanted, const std::vector<Marker>& markers) {
  return std::any_of(markers.begin(), markers.end(),
                     [&](const Marker& m) { return m.id == wanted.id && m.ns == wanted.ns; });
}

}  // namespace

std::string captionOf(const Object& object) {
  const std::string coarse = wordsOf(object.coarse);
  if (object.label.empty()) return coarse + "?";
  const std::string label = object.label + " " + std::to_string(std::lround(object.score * 100)) + " %";
  const bool says_more = object.coarse_score > object.score && coarse != object.label;
  return says_more ? label + " (" + coarse + "?)" : label;
}

cv::Mat drawOverlay(const DepthView& depth, const Segments& segments, const Objects& objects) {
  cv::Mat image = greyImage(depth);
  drawOutline(depth.camera, segments.table, &image);
  for (const DroppedCluster& cluster : segments.dropped_clusters) drawDropped(cluster, &image);
  for (const Segment& segment : segments.segments) tint(segment, &image);
  for (const Object& object : objects.objects) drawObject(object, &image);
  if (objects.objects.empty()) write(statusName(objects.status), {8, image.rows - 10}, image.cols / 1000.0, &image);
  return image;
}

visualization_msgs::MarkerArray markersOf(const Objects& objects, const AlignedModels& models,
                                          const visualization_msgs::MarkerArray& previous) {
  visualization_msgs::MarkerArray array;
  if (!objects.table.outline.empty()) array.markers.push_back(outlineOf(objects));
  for (const Object& object : objects.objects) {
    array.markers.push_back(boxOf(objects, object));
    array.markers.push_back(captionMarker(objects, object));
    if (object.model_pose.status != ModelPose::ALIGNED) continue;
    array.markers.push_back(modelOf(objects, object));
    if (const AlignedModel* const model = find(models, object.model_pose))
      array.markers.push_back(surfaceOf(objects, object, *model));
  }
  for (const Marker& shown : previous.markers) {
    if (shown.action == Marker::ADD && !isThere(shown, array.markers))
      array.markers.push_back(deletion(objects, shown.ns.c_str(), shown.id));
  }
  return array;
}

}  // namespace voxid
