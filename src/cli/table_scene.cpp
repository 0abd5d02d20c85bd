// SPDX-License-Identifier: BSD-3-Clause
#include "table_scene.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

namespace voxid::cli {
namespace {

using Eigen::Matrix3f;
using Eigen::Vector3f;

constexpr float kTableWidthMm = 1200, kTableDepthMm = 800, kTableThicknessMm = 30;
constexpr float kRowWidthMm = 720, kRowsDepthMm = 640;  ///< what the camera sees of the table with room to spare
constexpr float kGapMm = 50, kJitterMm = 12;
constexpr float kDegree = 3.14159265f / 180;

using Generator = std::mt19937_64;

/// [low, high); the standard's distributions differ between libraries, its generators do not.
float between(Generator& random, float low, float high) {
  return low + (high - low) * static_cast<float>(random() >> 40) / static_cast<float>(1 << 24);
}

Mesh tableMesh() {
  Mesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.vertices.push_back({(i & 1 ? 0.5f : -0.5f) * kTableWidthMm, (i & 2 ? 0.5f : -0.5f) * kTableDepthMm,
                             i & 4 ? 0 : -kTableThicknessMm});
  }
  constexpr std::uint32_t kSides[6][4] = {{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                          {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}};
  for (const auto& side : kSides) {
    mesh.triangles.push_back({side[0], side[1], side[2]});
    mesh.triangles.push_back({side[0], side[2], side[3]});
  }
  return mesh;
}

/// A prop turned upright, in millimetres, centred over the origin and standing on z = 0.
struct Standing {
  std::size_t number = 0;  ///< of the prop
  Placement placement;
  float radius_mm = 0, height_mm = 0;  ///< of the upright cylinder round it
};

Standing stand(const Prop& prop, std::size_t number, float turn_rad) {
  Matrix3f upright = Matrix3f::Identity();
  if (prop.y_up) upright << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  const MeshBox box = boxOf(prop.mesh);
  const auto centre = box.centre();
  const Vector3f middle(static_cast<float>(centre[0]), static_cast<float>(centre[1]), static_cast<float>(centre[2]));
  Standing standing;
  standing.number = number;
  standing.placement.scale = static_cast<float>(prop.size_mm / box.largestExtent());
  standing.placement.rotation = Eigen::AngleAxisf(turn_rad, Vector3f::UnitZ()).toRotationMatrix() * upright;
  Placement& at = standing.placement;
  at.translation = -(at.rotation * (at.scale * middle));
  const int up = prop.y_up ? 1 : 2;
  standing.height_mm = at.scale * static_cast<float>(box.high[up] - box.low[up]);
  at.translation.z() += standing.height_mm / 2;
  for (const auto& v : prop.mesh.vertices) {
    standing.radius_mm = std::max(standing.radius_mm, at(Vector3f(v[0], v[1], v[2])).head<2>().norm());
  }
  return standing;
}

struct Row {
  std::vector<Standing*> props;
  float width_mm = 0, depth_mm = 0;
};

std::vector<Row> fillRows(std::vector<Standing>& standing) {
  std::vector<Row> rows(1);
  for (Standing& one : standing) {
    const float width_mm = 2 * one.radius_mm + kGapMm;
    if (!rows.back().props.empty() && rows.back().width_mm + width_mm > kRowWidthMm) rows.emplace_back();
    rows.back().props.push_back(&one);
    rows.back().width_mm += width_mm;
    rows.back().depth_mm = std::max(rows.back().depth_mm, width_mm);
  }
  return rows;
}

void placeRow(const Row& row, float y_mm, Generator& random) {
  const float spare_mm = std::max(0.0f, kRowWidthMm - row.width_mm) / static_cast<float>(row.props.size());
  float x_mm = -std::max(kRowWidthMm, row.width_mm) / 2;
  for (Standing* const one : row.props) {
    const float width_mm = 2 * one->radius_mm + kGapMm + spare_mm;
    one->placement.translation.x() += x_mm + width_mm / 2 + between(random, -kJitterMm, kJitterMm);
    one->placement.translation.y() += y_mm + between(random, -kJitterMm, kJitterMm);
    x_mm += width_mm;
  }
}

Status placeRows(const std::vector<Row>& rows, Generator& random) {
  float depth_mm = 0, width_mm = 0;
  for (const Row& row : rows) {
    depth_mm += row.depth_mm;
    width_mm = std::max(width_mm, row.width_mm);
  }
  if (depth_mm > kRowsDepthMm || width_mm > kRowWidthMm) {
    return Status::badUse("the models take " + std::to_string(static_cast<int>(width_mm / 10)) + " x " +
                          std::to_string(static_cast<int>(depth_mm / 10)) + " cm, the table has room for " +
                          std::to_string(static_cast<int>(kRowWidthMm / 10)) + " x " +
                          std::to_string(static_cast<int>(kRowsDepthMm / 10)) + "; take fewer, or smaller --sizes");
  }
  float y_mm = depth_mm / 2;
  for (const Row& row : rows) {
    placeRow(row, y_mm - row.depth_mm / 2, random);
    y_mm -= row.depth_mm;
  }
  return {};
}

Placement drawCamera(Generator& random) {
  const float tilt_rad = between(random, 30, 45) * kDegree, yaw_rad = between(random, -10, 10) * kDegree;
  const float distance_mm = between(random, 900, 1050);
  Matrix3f axes;  // columns: the table's x, y and z in the camera's frame
  axes << 1, 0, 0, 0, -std::sin(tilt_rad), -std::cos(tilt_rad), 0, std::cos(tilt_rad), -std::sin(tilt_rad);
  Placement camera;
  camera.rotation = axes * Eigen::AngleAxisf(yaw_rad, Vector3f::UnitZ()).toRotationMatrix();
  camera.translation = Vector3f(0, 0, distance_mm);
  return camera;
}

}  // namespace

Result<TableScene> setTable(const std::vector<Prop>& props, std::uint64_t seed) {
  Generator random(seed);
  std::vector<Standing> standing;
  for (std::size_t i = 0; i < props.size(); ++i)
    standing.push_back(stand(props[i], i, between(random, 0, 360) * kDegree));
  std::stable_sort(standing.begin(), standing.end(),
                   [](const Standing& a, const Standing& b) { return a.height_mm > b.height_mm; });
  const Status status = placeRows(fillRows(standing), random);
  if (!status.ok()) return status;

  std::sort(standing.begin(), standing.end(), [](const Standing& a, const Standing& b) { return a.number < b.number; });
  TableScene table;
  table.scene.add(tableMesh(), Placement());
  for (std::size_t i = 0; i < props.size(); ++i) table.scene.add(props[i].mesh, standing[i].placement);
  table.scene.commit();
  table.camera = drawCamera(random);
  return table;
}

SensorParams sceneSensor() {
  SensorParams params;
  params.most_holes = 12;
  params.cut_share = 0;
  return params;
}

}  // namespace voxid::cli
