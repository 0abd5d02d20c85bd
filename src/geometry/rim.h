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

  /// Each region takes low pixels from its border on, a few pixels far. The regions' runs are ours until the next
  /// call.
  void grow(const Surface& surface, const SegmentParams& params, std::vector<Region>& regions);

 private:
  struct Added {
    std::uint32_t region, pixel;

    bool operator<(Added other) const { return key() < other.key(); }
    std::uint64_t key() const { return std::uint64_t{region} << 32 | pixel; }
  };

  void freeOthers(const std::vector<Region>& regions, const InverseDepth& inverse);
  void growRuns(const Surface& surface, std::uint32_t region, Span<const Run> runs);
  void growPixel(const Surface& surface, Added added);
  void take(const Surface& surface, Added next, std::uint32_t from, int v);
  void merge(std::uint32_t width, std::vector<Region>& regions);

  DepthStep gap_;
  AboveTable low_;
  std::vector<std::uint8_t> free_;  ///< by pixel: 1 = of no region
  std::vector<Added> added_;        ///< by region
  std::vector<Run> runs_;
};

}  // namespace voxid
