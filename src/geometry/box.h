// SPDX-License-Identifier: BSD-3-Clause
// A cluster's pixels become its measures.
#pragma once

#include <vector>

#include "inverse_depth.h"
#include "outermost.h"
#include "surface.h"
#include "voxid/geometry/scene.h"

namespace voxid {

/// The smallest box around ascending runs; at least one.
PixelBox pixelBoxOf(Span<const Run> runs, int width_px);
/// The same around ascending pixels.
PixelBox pixelBoxOf(Span<const std::uint32_t> pixels, int width_px);

/// Pixel box, centroid, and the smallest box that stands on the table around the points.
class BoxFitter {
 public:
  BoxFitter();
  void reserve(std::size_t pixels);

  /// Sets everything in `cluster` that follows from `cluster.pixels`; `truncated` too if the image's border cuts it.
  void fit(const Surface& surface, Cluster& cluster);

 private:
  struct Column {
    Point2 lowest, highest;
  };
  void placeAll(const Surface& surface, Cluster& cluster);
  void bin(Span<const Point2> points);
  std::size_t hull();

  PlacedPoints placed_;  // of one cluster
  Outermost outermost_;
  std::vector<Column> columns_;
  std::vector<Point2> sorted_, hull_;
};

}  // namespace voxid
