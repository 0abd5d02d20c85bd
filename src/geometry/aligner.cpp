// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "drawn_object.h"
#include "looks.h"
#include "pose_refiner.h"
#include "voxid/geometry/alignment.h"

namespace voxid {
namespace {

using Eigen::Vector3f;

constexpr std::size_t kLeastPixels = 20;

constexpr PoseRefiner::Schedule coarseSchedule(int steps) { return {steps, 0.15f, 0.04f}; }
constexpr PoseRefiner::Schedule fineSchedule(int steps) { return {steps, 0.04f, 0.008f}; }

/// So much more misfit is noise.
constexpr float kAlikeMisfit = 0.01f;
/// Variance of an angle that may be any, in radians squared.
constexpr float kAnyAngle = 3.2898681f;
constexpr std::array<float, 2> kTriedAngles{-0.35f, 0.35f};  // 20 degrees

Placement turnedAbout(const Vector3f& axis, float angle, Placement pose) {
  pose.rotation = Eigen::AngleAxisf(angle, axis).toRotationMatrix() * pose.rotation;
  return pose;
}

float angleBetween(const Placement& a, const Placement& b) {
  return Eigen::AngleAxisf(Eigen::Matrix3f(a.rotation.transpose() * b.rotation)).angle();
}

/// Turned by any angle the model fits as well; its box's centre goes round at `arm_mm` from the axis.
void setFree(const Vector3f& axis, float arm_mm, Alignment& found) {
  const Eigen::Matrix3f along = axis * axis.transpose();
  found.rotation_known = false;
  found.free_axis = axis;
  found.covariance.block<3, 3>(0, 0) += arm_mm * arm_mm * (Eigen::Matrix3f::Identity() - along);
  found.covariance.block<3, 3>(3, 3) += kAnyAngle * along;
}

}  // namespace

struct Aligner::Workspace {
  AlignParams params;
  SupportPlane support;
  Observation coarse, fine, whole;
  bool usable = false;
  PoseRefiner refiner;
  DrawnObject drawn;

  Alignment refined(const AlignableModel& model, const Sketch& sketch);
  void findFreeAxis(const AlignableModel& model, Alignment& found);
  bool turnsFreely(const AlignableModel& model, const Alignment& found, const Vector3f& axis);
  void turnOnTable(const AlignableModel& model, Alignment& found);
  bool fitsAsWell(const AlignableModel& model, const Placement& pose, const Alignment& found);
};

Alignment Aligner::Workspace::refined(const AlignableModel& model, const Sketch& sketch) {
  Alignment result;
  result.pose = sketch.pose;
  refiner.refine(model.surface(), fine, support, fineSchedule(params.fine_steps), params.outline, result.pose);
  PoseRefiner::lift(model.surface(), support, result.pose);
  const Placement& pose = result.pose;
  if (!pose.rotation.allFinite() || !pose.translation.allFinite() || !std::isfinite(pose.scale)) return {};
  const Judgement judgement = refiner.judge(model.surface(), fine, support, pose);
  result.found = true;
  result.misfit = judgement.misfit;
  result.explained = judgement.explained;
  result.fit_mm = judgement.fit_mm;
  return result;
}

bool Aligner::Workspace::fitsAsWell(const AlignableModel& model, const Placement& pose, const Alignment& found) {
  return refiner.judge(model.surface(), fine, support, pose).misfit < found.misfit + kAlikeMisfit;
}

/// Tried out: facets and noise make a bottle's rotation look known to the equations.
bool Aligner::Workspace::turnsFreely(const AlignableModel& model, const Alignment& found, const Vector3f& axis) {
  return std::all_of(kTriedAngles.begin(), kTriedAngles.end(),
                     [&](float angle) { return fitsAsWell(model, turnedAbout(axis, angle, found.pose), found); });
}

/// Turned on the table either way and refined, does it fit as well without turning back? Then what would tell is
/// hidden, as a mug's handle is that lies behind it. One way is enough: what was found may be at the end of what is
/// hidden.
void Aligner::Workspace::turnOnTable(const AlignableModel& model, Alignment& found) {
  constexpr PoseRefiner::Schedule kFewSteps{4, 0.02f, 0.008f};
  constexpr float kTurnedBack = 0.12f;  // 7 degrees
  for (const float angle : kTriedAngles) {
    Placement turned = turnedAbout(support.normal, angle, found.pose);
    refiner.refine(model.surface(), fine, support, kFewSteps, params.outline, turned);
    const float by = angleBetween(turned, found.pose);
    if (by < kTurnedBack || !fitsAsWell(model, turned, found)) continue;
    return setFree(support.normal, (turned.translation - found.pose.translation).norm() / by, found);
  }
}

void Aligner::Workspace::findFreeAxis(const AlignableModel& model, Alignment& found) {
  for (int i = 0; i < 3; ++i) {
    const Vector3f axis = found.pose.rotation.col(i);
    if (turnsFreely(model, found, axis)) return setFree(axis, 0, found);
  }
  if (!support.normal.isZero()) turnOnTable(model, found);
}

Aligner::Aligner(const AlignParams& params) : workspace_(std::make_unique<Workspace>()) { workspace_->params = params; }
Aligner::~Aligner() = default;
Aligner::Aligner(Aligner&&) noexcept = default;
Aligner& Aligner::operator=(Aligner&&) noexcept = default;

void Aligner::observe(const ObservedObject& object) {
  Workspace& w = *workspace_;
  w.support = object.support;
  w.usable = object.pixels.size >= kLeastPixels && !object.depth.empty() && object.depth.camera.valid();
  if (!w.usable) return;
  voxid::observe(object, w.params.coarse_pixels, w.coarse);
  voxid::observe(object, w.params.fine_pixels, w.fine);
  cutOut(object, static_cast<int>(object.pixels.size), w.whole);
  w.usable = w.coarse.cells.size() >= kLeastPixels / 2 && w.coarse.radius_mm > 0;
}

float Aligner::misfitAt(const AlignableModel& model, const Placement& pose) {
  Workspace& w = *workspace_;
  return w.usable ? w.refiner.judge(model.surface(), w.fine, w.support, pose).misfit : 1;
}

ObservedObject Aligner::drawn(const AlignableModel& model, const Placement& pose) {
  Workspace& w = *workspace_;
  return w.usable ? w.drawn.draw(model.surface(), pose, w.whole) : ObservedObject{};
}

std::vector<Sketch> Aligner::sketch(const AlignableModel& model, int starts) {
  Workspace& w = *workspace_;
  std::vector<Sketch> sketches;
  if (!w.usable) return sketches;
  for (const Start& start : findStarts(model.looks(), w.fine, starts)) {
    Sketch sketch{start.pose, 1};
    w.refiner.refine(model.sketchSurface(), w.coarse, w.support, coarseSchedule(w.params.coarse_steps),
                     w.params.outline, sketch.pose);
    sketch.misfit = w.refiner.judge(model.sketchSurface(), w.coarse, w.support, sketch.pose).misfit;
    sketches.push_back(sketch);
  }
  std::stable_sort(sketches.begin(), sketches.end(),
                   [](const Sketch& a, const Sketch& b) { return a.misfit < b.misfit; });
  return sketches;
}

Alignment Aligner::finish(const AlignableModel& model, Span<const Sketch> sketches) {
  Workspace& w = *workspace_;
  Alignment best;
  if (!w.usable) return best;
  for (const Sketch& sketch : sketches) {
    const Alignment refined = w.refined(model, sketch);
    if (refined.found && (!best.found || refined.misfit < best.misfit)) best = refined;
  }
  if (!best.found) return best;
  best.covariance = w.refiner.covarianceAt(model.surface(), w.fine, w.support, w.params.outline, best.pose);
  w.findFreeAxis(model, best);
  return best;
}

Alignment Aligner::align(const AlignableModel& model) {
  const AlignParams& params = workspace_->params;
  const std::vector<Sketch> sketches = sketch(model, params.coarse_starts);
  const std::size_t fine_starts = std::min(sketches.size(), static_cast<std::size_t>(params.fine_starts));
  return finish(model, {sketches.data(), fine_starts});
}

}  // namespace voxid
