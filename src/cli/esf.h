// SPDX-License-Identifier: BSD-3-Clause
// PCL's ESF, the descriptor that voxid is compared with.
#pragma once

#include <memory>
#include <vector>

#include "voxid/core/depth_view.h"
#include "voxid/core/span.h"

namespace voxid::cli {

constexpr int kEsfBins = 640;

/// pcl::ESFEstimation with a guard: on some clouds (two points, all points equal) it never returns.
class Esf {
 public:
  virtual ~Esf() = default;

  /// Takes the cloud and says whether ESF would answer: it draws triples until it has 20,000 that span a triangle, so
  /// some of them must.
  virtual bool accept(Span<const PointUm> points) = 0;
  /// The 640 bins of the cloud that was accepted; they differ from second to second, as ESF seeds itself by the clock.
  virtual const std::vector<float>& describe() = 0;
};
std::unique_ptr<Esf> makeEsf();

}  // namespace voxid::cli
