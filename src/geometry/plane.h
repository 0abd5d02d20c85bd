// SPDX-License-Identifier: BSD-3-Clause
// The support plane in inverse depth.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "inverse_depth.h"
#include "voxid/geometry/segment_params.h"

namespace voxid {

/// Inverse depth = per_u u + per_v v + at_origin, in units of InverseDepth.
struct InversePlane {
  double per_u = 0, per_v = 0, at_origin = 0;
};

/// The same plane in the camera's frame: normal . p + distance_m = 0, normal towards the camera, distance_m > 0.
struct MetricPlane {
  Eigen::Vector3d normal{0, 0, 0};
  double distance_m = 0;
};
MetricPlane metricOf(const InversePlane& plane, const Camera& camera);

/// A plane's inverse depth at pixel (u, v) is columns[u] + rows[v]: integers, one addition a pixel.
struct PlaneSums {
  std::vector<std::int32_t> columns, rows;

  void reserve(int width_px, int height_px);
  void fill(const InversePlane& plane, int width_px, int height_px);
};

/// Which way is up, as a unit vector in the camera's frame, and how far a table's normal may lean from it.
struct Upward {
  Eigen::Vector3d direction{0, -1, 0};
  int max_tilt_deg = 100;
};

/// RANSAC over a regular subsample, then least squares over all pixels.
class PlaneFinder {
 public:
  void reserve(int width_px, int height_px);

  /// False if no plane has enough pixels. Otherwise `plane` and `sums` (its table) are set.
  bool find(const InverseDepth& inverse, const Camera& camera, const SegmentParams& params, const Upward& upward,
            InversePlane& plane, PlaneSums& sums);

  struct Samples {
    std::vector<float> u, v, inverse;  ///< whole numbers below 2^24

    void reserve(std::size_t most);
    void clear();
    void add(std::int32_t at_u, std::int32_t at_v, std::int32_t value);
    std::size_t size() const { return u.size(); }
  };
  /// Samples within the limit of the plane normal . (u, v, inverse) = offset; gives up, with fewer, once they cannot
  /// exceed `most`.
  static int countInliers(const Samples& samples, const Eigen::Vector3d& normal, double offset, double limit, int most);
  /// No fewer than countInliers finds, and faster: the tolerance, in units of inverse depth, is widened by
  /// more than the roundings of single precision, eight units in the last place of the sum of all terms.
  static int mostInliers(const Samples& samples, const InversePlane& plane, double tolerance);

 private:
  struct Candidate {
    InversePlane plane;
    int inliers = 0;
  };
  class Draws;

  void takeSamples(const InverseDepth& inverse);
  template <typename Accept>
  Candidate draw(const Samples& samples, const SegmentParams& params, Accept accept) const;
  Candidate tableAboveFloor(Candidate floor, const Camera& camera, const SegmentParams& params);

  Samples samples_, above_;
};

/// Pixels whose inverse depth is within `tolerance` (units) of the plane, and the root mean square of their heights.
struct PlaneSupport {
  std::uint32_t inliers = 0;
  double residual_mm = 0;
};
PlaneSupport supportOf(const InverseDepth& inverse, const PlaneSums& sums, std::int32_t tolerance, double distance_m);

/// Tolerance of the last refit, the outline and the residual.
inline std::int32_t fineTolerance(const SegmentParams& params) {
  return params.plane_inlier_per_km * kUnitsPerKm * 6 / 10;
}

}  // namespace voxid
