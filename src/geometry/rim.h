// SPDX-License-Identifier: BSD-3-Clause
// Objects stand on the table: their lowest points are too low to be told from it alone, but not beside a higher one.
#pragma once

#include <cstdint>
#include <vector>

#include "above_table.h"
#include "surface.h"
#include "voxid/geometry/scene.h"
#include "voxid/geometry/segment_params.h"

namespace voxid {

class RimGrower {
 public:
  void reserve(std::size_t pixels, int width_px, int height_px);

  /// Each cluster takes low pixels from its border on, a few pixels far. The clusters' pixels are ours until the next
  /// call.
  void grow(const Surface& surface, const SegmentParams& params, std::vector<Cluster>& clusters);

 private:
  struct Added {
    std::uint32_t cluster, pixel;
  };

  void takeClusters(const std::vector<Cluster>& clusters, const InverseDepth& inverse);
  template <typename Block>
  bool surrounded(std::uint32_t pixel, std::uint32_t width) const;
  void visitBorder(const Surface& surface, std::uint32_t cluster, Run run);
  void visitNeighbours(const Surface& surface, std::uint32_t cluster, std::uint32_t pixel);
  void merge(std::vector<Cluster>& clusters);

  DepthStep gap_;
  AboveTable low_;
  std::vector<std::uint8_t> taken_;  ///< by pixel
  std::vector<Added> added_;
  std::vector<std::uint32_t> pixels_;
};

}  // namespace voxid
