// SPDX-License-Identifier: BSD-3-Clause
#include "pose_refiner.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>

namespace voxid {
namespace {

using Eigen::Vector3f;

/// Of structured light: disparity is known to 0.09 px (noise and steps of 1/8 px), the projector is 75 mm away; f is
/// 525 px at the full image, so a depth's deviation is its square times this.
constexpr float kDepthNoisePerMm = 0.09f / (525 * 75);
/// The ray is not known better than this: half a pixel of a camera of f = 525 px.
constexpr float kRayNoise = 0.3f / 525;

float noiseOf(float depth_mm, const Vector3f& normal) {
  const float along = kDepthNoisePerMm * depth_mm * depth_mm * normal.z();
  const float across_squared =
      std::max(0.0f, 1 - normal.z() * normal.z()) * kRayNoise * kRayNoise * depth_mm * depth_mm;
  return std::sqrt(along * along + across_squared + 0.04f);
}

/// A residual along a direction, at a point of the model.
PoseVector slopeOf(const Vector3f& direction, const Vector3f& point, const Vector3f& centre) {
  const Vector3f arm = point - centre;
  PoseVector slope;
  slope << direction, arm.cross(direction), direction.dot(arm);
  return slope;
}

/// Unknowns in mm at the model's surface, so that one number can damp them all.
PoseVector unitsOf(float diagonal_mm) {
  const float arm = 0.3f * diagonal_mm;
  PoseVector units;
  units << 1, 1, 1, 1 / arm, 1 / arm, 1 / arm, 1 / arm;
  return units;
}

/// Far residuals say little about this pose and perhaps much about another.
float robust(float residual_mm, float reach_mm) {
  const float ratio = residual_mm / reach_mm;
  const float share = 1 / (1 + ratio * ratio);
  return share * share;
}

void turn(Placement& pose, const Vector3f& by) {
  const float angle = by.norm();
  if (angle > 1e-9f) pose.rotation = Eigen::AngleAxisf(angle, by / angle).toRotationMatrix() * pose.rotation;
}

/// No step is longer than this; the model is drawn anew after it.
constexpr float kLongestTurn = 0.35f, kMostGrowth = 0.15f;

void apply(const PoseVector& step, Placement& pose) {
  Vector3f rotation = step.segment<3>(3);
  rotation *= std::min(1.0f, kLongestTurn / std::max(1e-9f, rotation.norm()));
  turn(pose, rotation);
  pose.translation += step.head<3>();
  pose.scale *= std::exp(std::clamp(step[6], -kMostGrowth, kMostGrowth));
}

PoseMatrix informationOf(const std::vector<PoseEquation>& equations, PoseVector& gradient) {
  PoseMatrix information = PoseMatrix::Zero();
  gradient.setZero();
  for (const PoseEquation& e : equations) {
    const PoseVector weighted = e.weight * e.slope;
    information += weighted * e.slope.transpose();
    gradient += e.residual_mm * weighted;
  }
  return information;
}

/// Adds the share `damping` of what an unknown gets on average; in units of mm. Little: a face seen from the front says
/// nothing about the scale but by its outline, which is a small share of all that is known.
PoseMatrix damped(const PoseMatrix& information, float damping, const PoseVector& units) {
  const PoseMatrix scaled = units.asDiagonal() * information * units.asDiagonal();
  return scaled + (damping * scaled.trace() / kPoseUnknowns + 1e-6f) * PoseMatrix::Identity();
}

PoseVector stepOf(const std::vector<PoseEquation>& equations, float diagonal_mm) {
  const PoseVector units = unitsOf(diagonal_mm);
  PoseVector gradient;
  const PoseMatrix information = informationOf(equations, gradient);
  const PoseVector scaled_gradient = units.cwiseProduct(gradient);
  return units.cwiseProduct(damped(information, 1e-5f, units).ldlt().solve(scaled_gradient));
}

float distanceFrom(const SupportPlane& plane, const Vector3f& point) {
  return plane.normal.dot(point) + plane.distance_mm;
}

/// What a pixel of the model costs where the sensor saw nothing: it may have failed there.
constexpr float kNothingSeen = 0.7f;
/// A depth that differs by this much is as wrong as a pixel that is not covered.
constexpr float kWorstMm = 10;

/// Rounding makes small eigenvalues negative; none counts as less than a millionth of the largest.
PoseMatrix positiveInverse(const PoseMatrix& information) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(information.cast<double>());
  const double least = 1e-6 * std::max(solver.eigenvalues().maxCoeff(), 1e-12);
  const Eigen::VectorXd inverse = solver.eigenvalues().cwiseMax(least).cwiseInverse();
  return (solver.eigenvectors() * inverse.asDiagonal() * solver.eigenvectors().transpose()).cast<float>();
}

}  // namespace

void PoseRefiner::refine(const ModelSurface& surface, const Observation& seen, const SupportPlane& support,
                         const Schedule& schedule, bool outline, Placement& pose) {
  const float least_mm = 4 * kDepthNoisePerMm * seen.centroid_mm.squaredNorm();
  for (int i = 0; i < schedule.steps; ++i) {
    const float done = schedule.steps > 1 ? static_cast<float>(i) / static_cast<float>(schedule.steps - 1) : 1;
    const float share = schedule.first_reach * std::pow(schedule.last_reach / schedule.first_reach, done);
    painter_.draw(surface, pose, seen.grid);
    collect(seen, support, std::max(least_mm, share * pose.scale), outline, pose);
    if (equations_.size() < 2 * kPoseUnknowns) return;
    apply(stepOf(equations_, pose.scale), pose);
  }
}

void PoseRefiner::collect(const Observation& seen, const SupportPlane& support, float reach_mm, bool outline,
                          const Placement& pose) {
  equations_.clear();
  for (std::size_t cell = 0; cell < seen.grid.size(); ++cell) {
    if (seen.object[cell] && painter_.covers(cell)) addDepth(seen, cell, reach_mm, pose);
    if (!outline) continue;
    if (seen.object[cell] && !painter_.covers(cell)) addUncovered(seen, cell, reach_mm, pose);
    if (!seen.object[cell] && painter_.covers(cell)) addBare(seen, cell, reach_mm, pose);
  }
  addSupport(support, seen, pose);
}

void PoseRefiner::addDepth(const Observation& seen, std::size_t cell, float reach_mm, const Placement& pose) {
  const Vector3f normal = painter_.normalAt(cell, seen.grid), ray = seen.grid.ray(cell);
  const Vector3f drawn = ray * painter_.depth()[cell];
  const float residual_mm = normal.dot(ray) * (seen.depth_mm[cell] - painter_.depth()[cell]);
  const float noise_mm = noiseOf(seen.depth_mm[cell], normal);
  const float weight = robust(residual_mm, reach_mm) / (noise_mm * noise_mm);
  equations_.push_back({slopeOf(normal, drawn, pose.translation), residual_mm, weight, cell});
}

/// The object's pixel is to be covered: the nearest part of the model comes there.
void PoseRefiner::addUncovered(const Observation& seen, std::size_t cell, float reach_mm, const Placement& pose) {
  const int from = nearestSet(seen.grid, cell, [&](std::size_t c) { return painter_.covers(c); });
  if (from >= 0) addPull(seen, static_cast<std::size_t>(from), cell, 1, reach_mm, pose);
}

/// The model shows where the object is not: it goes to the object's nearest pixel. Half as strong, since sensors lose
/// pixels at outlines and where the surface is seen at a grazing angle.
void PoseRefiner::addBare(const Observation& seen, std::size_t cell, float reach_mm, const Placement& pose) {
  if (seen.nearest[cell] < 0 || hides(seen.depth_mm[cell], painter_.depth()[cell])) return;
  const auto towards = static_cast<std::size_t>(seen.nearest[cell]);
  const int du = seen.grid.columnOf(cell) - seen.grid.columnOf(towards),
            dv = seen.grid.rowOf(cell) - seen.grid.rowOf(towards);
  if (du * du + dv * dv <= 1) return;
  if (std::abs(painter_.normalAt(cell, seen.grid).dot(seen.grid.ray(cell).normalized())) < 0.2f) return;
  addPull(seen, cell, towards, 0.5f, reach_mm, pose);
}

void PoseRefiner::addPull(const Observation& seen, std::size_t model_cell, std::size_t towards, float weight,
                          float reach_mm, const Placement& pose) {
  const float depth_mm = painter_.depth()[model_cell];
  const Vector3f drawn = seen.grid.ray(model_cell) * depth_mm;
  const Vector3f gap = seen.grid.ray(towards) * depth_mm - drawn;
  const float noise_mm = 0.5f * depth_mm / seen.grid.fx;  // half a cell
  const float trust = weight * robust(gap.norm(), 2 * reach_mm) / (noise_mm * noise_mm);
  for (const Vector3f& axis : {Vector3f(Vector3f::UnitX()), Vector3f(Vector3f::UnitY())}) {
    equations_.push_back({slopeOf(axis, drawn, pose.translation), gap.dot(axis), trust, towards});
  }
}

/// The model's lowest point is to be on the plane, if it is below or not far above.
void PoseRefiner::addSupport(const SupportPlane& support, const Observation& seen, const Placement& pose) {
  if (support.normal.isZero() || painter_.vertices().empty()) return;
  const auto lower = [&](const Vector3f& a, const Vector3f& b) {
    return support.normal.dot(a) < support.normal.dot(b);
  };
  const Vector3f lowest = *std::min_element(painter_.vertices().begin(), painter_.vertices().end(), lower);
  const float height_mm = distanceFrom(support, lowest);
  if (height_mm > 12) return;
  const float weight = 0.05f * static_cast<float>(seen.cells.size()) / 4;  // a twentieth of the pixels, known to 2 mm
  equations_.push_back({slopeOf(support.normal, lowest, pose.translation), -height_mm, weight, 0});
}

void PoseRefiner::lift(const ModelSurface& surface, const SupportPlane& support, Placement& pose) {
  if (support.normal.isZero()) return;
  float lowest_mm = 0;
  for (const Vector3f& vertex : surface.vertices) lowest_mm = std::min(lowest_mm, distanceFrom(support, pose(vertex)));
  pose.translation += std::max(0.0f, -lowest_mm - SupportPlane::kMostBelow_mm) * support.normal;
}

PoseRefiner::Cost PoseRefiner::costOf(const Observation& seen, std::size_t cell) {
  const bool covered = painter_.covers(cell);
  if (seen.object[cell] && !covered) return {1, 1};
  if (!covered) return {};
  const float drawn_mm = painter_.depth()[cell];
  if (!seen.object[cell]) {
    if (hides(seen.depth_mm[cell], drawn_mm)) return {};
    return {seen.depth_mm[cell] > 0 ? 1 : kNothingSeen, 1};
  }
  const float off_mm = std::abs(seen.depth_mm[cell] - drawn_mm);
  if (off_mm >= kWorstMm) return {1, 1};
  distances_.push_back(off_mm * std::abs(painter_.normalAt(cell, seen.grid).dot(seen.grid.ray(cell))));
  return {off_mm / kWorstMm, 1};
}

float PoseRefiner::shareBelow(const SupportPlane& support) const {
  const auto& points = painter_.vertices();
  if (support.normal.isZero() || points.empty()) return 0;
  const auto below =
      std::count_if(points.begin(), points.end(), [&](const Vector3f& p) { return distanceFrom(support, p) < -5; });
  return static_cast<float>(below) / static_cast<float>(points.size());
}

Judgement PoseRefiner::judge(const ModelSurface& surface, const Observation& seen, const SupportPlane& support,
                             const Placement& pose) {
  painter_.draw(surface, pose, seen.grid);
  Cost sum;
  distances_.clear();
  for (std::size_t cell = 0; cell < seen.grid.size(); ++cell) {
    const Cost cost = costOf(seen, cell);
    sum.wrong += cost.wrong;
    sum.all += cost.all;
  }
  Judgement judgement;
  if (sum.all == 0 || seen.cells.empty()) return judgement;
  judgement.misfit = std::min(1.0f, sum.wrong / sum.all + shareBelow(support));
  judgement.explained = static_cast<float>(distances_.size()) / static_cast<float>(seen.cells.size());
  if (distances_.empty()) return judgement;
  const auto middle = distances_.begin() + static_cast<std::ptrdiff_t>(distances_.size() / 2);
  std::nth_element(distances_.begin(), middle, distances_.end());
  judgement.fit_mm = *middle;
  return judgement;
}

PoseCovariance PoseRefiner::covarianceAt(const ModelSurface& surface, const Observation& seen,
                                         const SupportPlane& support, bool outline, const Placement& pose) {
  constexpr int kBlock = 8;  // cells
  // Errors that a whole face has in common (quantised disparities, the drawing of the model) do not show as differences
  // between blocks: measured on views of known poses (doc/pose.md).
  constexpr float kCommonErrors = 5.75f;
  painter_.draw(surface, pose, seen.grid);
  collect(seen, support, 4 * kDepthNoisePerMm * seen.centroid_mm.squaredNorm(), outline, pose);
  PoseVector gradient;
  const PoseVector units = unitsOf(pose.scale);
  const PoseMatrix bread = damped(informationOf(equations_, gradient), 1e-6f, units);
  std::map<int, PoseVector> blocks;
  for (const PoseEquation& e : equations_) {
    const int block = seen.grid.rowOf(e.cell) / kBlock * seen.grid.width + seen.grid.columnOf(e.cell) / kBlock;
    const auto at = blocks.try_emplace(block, PoseVector::Zero()).first;
    at->second += e.weight * e.residual_mm * units.cwiseProduct(e.slope);
  }
  PoseMatrix meat = PoseMatrix::Zero();
  for (const auto& [block, sum] : blocks) meat += sum * sum.transpose();
  const auto count = static_cast<float>(blocks.size());
  const float for_unknowns = count / std::max(1.0f, count - kPoseUnknowns);
  const PoseMatrix inverse = positiveInverse(bread);
  const PoseMatrix scaled = for_unknowns * inverse * meat * inverse.transpose() + inverse;
  return kCommonErrors * units.asDiagonal() * scaled * units.asDiagonal();
}

}  // namespace voxid
