// SPDX-License-Identifier: BSD-3-Clause
// From "this is that model" to where it stands and how large it is.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "voxid/core/depth_view.h"
#include "voxid/core/index_format.h"
#include "voxid/core/span.h"
#include "voxid/geometry/placement.h"

namespace voxid {

/// A model's surface in the unit that an index has: its box is centred on the origin and has a diagonal of 1. Triangles
/// are two-sided and need not be closed. Vertex numbers must be below vertices.size().
struct ModelSurface {
  std::vector<Eigen::Vector3f> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// A surface made ready to be aligned: its look from each of a set of directions, at low resolution. Costs some
/// milliseconds and about 100 KiB once a model; constant afterwards, so threads may share it.
class AlignableModel {
 public:
  /// `directions`: those of the index, viewDirections() otherwise.
  AlignableModel(ModelSurface surface, Span<const format::Direction> directions);
  ~AlignableModel();
  AlignableModel(const AlignableModel&) = delete;
  AlignableModel& operator=(const AlignableModel&) = delete;

  const ModelSurface& surface() const { return surface_; }
  /// With fewer triangles, for low resolution.
  const ModelSurface& sketchSurface() const { return thinned_.triangles.empty() ? surface_ : thinned_; }

  struct Looks;
  const Looks& looks() const { return *looks_; }

 private:
  ModelSurface surface_, thinned_;  ///< thinned_ is empty if the surface has few triangles
  std::unique_ptr<Looks> looks_;
};

/// What stands on the table cannot reach below it. The plane itself is known to a millimetre or two: no vertex of an
/// aligned model lies more than kMostBelow_mm below.
struct SupportPlane {
  static constexpr float kMostBelow_mm = 2;
  Eigen::Vector3f normal{0, 0, 0};  ///< unit, away from the table; zero: there is no plane
  float distance_mm = 0;            ///< normal . p + distance_mm = 0 on the plane
};

/// What the camera saw of one object.
struct ObservedObject {
  DepthView depth;                   ///< the whole image: what is nearer than the object may hide a part of it
  Span<const std::uint32_t> pixels;  ///< the object's, row * width + column
  SupportPlane support;
};

/// What a search for the pose may cost. Every step draws the model anew.
struct AlignParams {
  int coarse_starts = 14;   ///< views with their roll that are refined at low resolution [1 to 64]
  int coarse_steps = 9;     ///< [1 to 50]
  int coarse_pixels = 350;  ///< about so many of the object's pixels are compared [50 to 5000]
  int fine_starts = 3;      ///< the best of them are refined further [1 to coarse_starts]
  int fine_steps = 12;      ///< [1 to 50]
  int fine_pixels = 1500;   ///< [50 to 20000]
  bool outline = true;      ///< draw outlines together; without, a flat face fits at any size
};

/// Order of the unknowns in a covariance: the model's box centre x, y, z (mm, camera frame), a small rotation about the
/// camera's x, y, z (radians) applied after `pose.rotation`, the logarithm of the scale.
constexpr int kPoseUnknowns = 7;
using PoseCovariance = Eigen::Matrix<float, kPoseUnknowns, kPoseUnknowns>;

/// Where a model stands. `found` is false, and the rest means nothing, if there was nothing to compare: fewer than 20
/// pixels with depth, no valid camera, a model that shows nothing.
struct Alignment {
  bool found = false;
  Placement pose;    ///< model (unit diagonal) to camera, mm; pose.scale is the box's diagonal
  float misfit = 1;  ///< 0 to 1: differing depth, object's pixels not covered, model's pixels where nothing is; a share
                     ///< of all pixels of either
  float explained = 0;  ///< 0 to 1: share of the object's pixels that the model covers at their depth
  float fit_mm = 0;     ///< median distance of those from the model's surface
  PoseCovariance covariance = PoseCovariance::Zero();  ///< of the errors' distribution, from residuals and geometry,
                                                       ///< about this pose; how honest: doc/pose.md
  bool rotation_known = true;          ///< false: turned about `free_axis` the model fits as well, or what would tell
                                       ///< is hidden (a mug's handle behind it)
  Eigen::Vector3f free_axis{0, 0, 0};  ///< unit, camera frame, through the box centre: an axis of the model, or the
                                       ///< normal of the support; zero if rotation_known
};

/// A pose at low resolution.
struct Sketch {
  Placement pose;
  float misfit = 1;  ///< see Alignment
};

/// Aligns models with objects. Owns the memory that this takes. One object a thread. Same in, same out.
class Aligner {
 public:
  explicit Aligner(const AlignParams& params = {});
  ~Aligner();
  Aligner(Aligner&&) noexcept;
  Aligner& operator=(Aligner&&) noexcept;

  /// Sets the object that the following calls are about.
  void observe(const ObservedObject& object);

  /// Alignment::misfit of the model in a given pose.
  float misfitAt(const AlignableModel& model, const Placement& pose);

  /// What the camera would see of the model in that pose, in the object's stead: an image round the object, as large as
  /// its box and a third to each side, in whole millimetres without noise. What hides the model is left out, and of its
  /// outline every second pixel, as in views of an index. Belongs to the aligner until its next call; empty if there is
  /// nothing to compare.
  ObservedObject drawn(const AlignableModel& model, const Placement& pose);

  /// The best pose from every view of the model: finish() of params.fine_starts of params.coarse_starts sketches.
  Alignment align(const AlignableModel& model);

  /// Poses from `starts` views and rolls, refined at low resolution; best first. What it takes to choose among models.
  std::vector<Sketch> sketch(const AlignableModel& model, int starts);
  /// The best of some sketches of the model, refined at high resolution.
  Alignment finish(const AlignableModel& model, Span<const Sketch> sketches);

 private:
  struct Workspace;
  std::unique_ptr<Workspace> workspace_;
};

}  // namespace voxid
