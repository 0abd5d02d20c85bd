// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/geometry/steady_solid.h"

namespace voxid {
namespace {

constexpr float kWorse = 1.5f, kWorse_mm = 1;
/// So much nearer another solid of its kind must lie. Between box and cylinder primitiveOf decides at 0.8 times the
/// box's misfit: about that each stays what it was, as noise moves the ratio by some 0.1.
constexpr float kNearer = 0.8f, kCylinderNearer = 0.7f, kBoxNearer = 1.1f;

bool fitsAsBefore(float misfit_mm, const Primitive& solid) { return misfit_mm <= kWorse * solid.misfit_mm + kWorse_mm; }

bool isBetter(const Primitive& anew, const Primitive& before, float misfit_mm) {
  const bool same_kind = anew.kind == before.kind, is_box = anew.kind == PrimitiveKind::Box;
  return anew.misfit_mm < misfit_mm * (same_kind ? kNearer : is_box ? kBoxNearer : kCylinderNearer);
}

VisibleBox moved(const Eigen::Isometry3d& move, const VisibleBox& box) { return {move * box.centre_m, box.extents_m}; }

Primitive moved(const Eigen::Isometry3d& move, Primitive solid) {
  solid.centre_m = (move * solid.centre_m.cast<double>()).cast<float>();
  solid.axes = (move.linear() * solid.axes.cast<double>()).cast<float>();
  return solid;
}

}  // namespace

bool VisibleBox::holds(const VisibleBox& other) const {
  return (other.centre_m - centre_m).norm() <= kRest_m + (other.extents_m - extents_m).norm() / 2;
}

Primitive SteadySolid::see(const DepthView& depth, Span<const std::uint32_t> pixels, const OrientedBox& box,
                           const Eigen::Isometry3d& rest_from_camera, bool looks_for_better) {
  const VisibleBox seen{box.centre_m.cast<double>(), box.size_m.cast<double>()};
  const Eigen::Isometry3d camera_from_then =
      found_ ? rest_from_camera.inverse() * found_->rest_from_camera : Eigen::Isometry3d::Identity();
  const bool rests = found_ && moved(camera_from_then, found_->seen).holds(seen);
  const Primitive before = rests ? moved(camera_from_then, found_->solid) : Primitive();
  const float misfit_mm = rests ? misfitOf(depth, pixels, before) : 0;
  if (rests && !looks_for_better && fitsAsBefore(misfit_mm, before)) return before;
  const Primitive anew = primitiveOf(depth, pixels, box);
  if (rests && !isBetter(anew, before, misfit_mm)) return before;
  found_ = {anew, seen, rest_from_camera};
  return anew;
}

}  // namespace voxid
