// SPDX-License-Identifier: BSD-3-Clause
#include "model_pose.h"

#include <cmath>

#include "conversions.h"
#include "voxid/library/surface_points.h"

namespace voxid {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;

Eigen::Vector3d extentsOf(const ModelSurface& surface) {
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& vertex : surface.vertices) box.extend(vertex);
  return surface.vertices.empty() ? Eigen::Vector3d::Zero() : Eigen::Vector3d(box.sizes().cast<double>());
}

/// Positions in metres, and without the scale.
Matrix6 poseCovarianceOf(const PoseCovariance& covariance) {
  Eigen::Matrix<double, 6, 1> unit;
  unit << 1e-3, 1e-3, 1e-3, 1, 1, 1;
  return unit.asDiagonal() * covariance.topLeftCorner<6, 6>().cast<double>() * unit.asDiagonal();
}

}  // namespace

ModelPose modelPoseOf(const Alignment& alignment, const ModelSurface& surface, const Symmetry& symmetry) {
  ModelPose message;
  message.status = ModelPose::NOT_FOUND;
  if (!alignment.found) return message;
  message.status = ModelPose::ALIGNED;
  const Eigen::Matrix3d rotation = alignment.pose.rotation.cast<double>();
  const double scale_m = static_cast<double>(alignment.pose.scale) * 1e-3;
  message.pose.pose.position = pointOf(alignment.pose.translation.cast<double>() * 1e-3);
  message.pose.pose.orientation = quaternionOf(Eigen::Quaterniond(rotation).normalized());
  Eigen::Map<Matrix6>(message.pose.covariance.data()) = poseCovarianceOf(alignment.covariance);
  message.scale_m = static_cast<float>(scale_m);
  message.scale_deviation_m = static_cast<float>(scale_m * std::sqrt(std::max(0.0f, alignment.covariance(6, 6))));
  message.extents_m = vectorOf(scale_m * extentsOf(surface));
  message.fit_mm = alignment.fit_mm;
  message.explained = alignment.explained;
  message.rotation_known = alignment.rotation_known;
  message.free_axis = vectorOf(alignment.free_axis.cast<double>());
  for (std::size_t i = 0; i < 3; ++i) message.symmetry[i] = symmetry.folds[i];
  return message;
}

AlignedModel alignedModelOf(const ModelSurface& surface) {
  constexpr float kDiagonal_um = 1e6f;  // that of the box in surfacePoints, whose y and z are turned over, too
  Mesh mesh;
  for (const Eigen::Vector3f& v : surface.vertices) mesh.vertices.push_back({v.x(), v.y(), v.z()});
  mesh.triangles = surface.triangles;
  AlignedModel model;
  for (const PointUm& p : surfacePoints(mesh, kModelPoints)) {
    geometry_msgs::Point32 point;
    point.x = static_cast<float>(p.x) / kDiagonal_um;
    point.y = static_cast<float>(-p.y) / kDiagonal_um;
    point.z = static_cast<float>(-p.z) / kDiagonal_um;
    model.points.push_back(point);
  }
  return model;
}

void transform(const Eigen::Isometry3d& target_from_camera, ModelPose* model_pose) {
  if (model_pose->status != ModelPose::ALIGNED) return;
  geometry_msgs::Pose& pose = model_pose->pose.pose;
  const Eigen::Matrix3d turn = target_from_camera.rotation();
  pose.position = pointOf(target_from_camera * eigenOf(pose.position));
  pose.orientation = quaternionOf(Eigen::Quaterniond(turn) * eigenOf(pose.orientation));
  Matrix6 turns = Matrix6::Zero();
  turns.topLeftCorner<3, 3>() = turns.bottomRightCorner<3, 3>() = turn;
  Eigen::Map<Matrix6> covariance(model_pose->pose.covariance.data());
  covariance = (turns * covariance * turns.transpose()).eval();
  model_pose->free_axis = vectorOf(turn * eigenOf(model_pose->free_axis));
}

}  // namespace voxid
