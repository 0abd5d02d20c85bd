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

/// Pixel box, centroid, and the smallest box that stands on the table around the points.
class BoxFitter {
 public:
  BoxFitter();
  void reserve(std::size_t pixels);

  /// Sets everything in `cluster` that follows from where its pixels are; `truncated` too if the image's border cuts
  /// it. Measures every `row_step`-th row, more of a low object, and of the others the ends of the runs, which outline
  /// it.
  void fit(const Surface& surface, const Region& region, int row_step, Cluster& cluster);

 private:
  struct Column {
    Point2 lowest, highest;
  };
  std::size_t place(const Surface& surface, const Region& region, int row_step);
  void bin(Span<const Point2> points);
  std::size_t hull();

  PlacedPoints placed_;  // of one cluster
  Outermost outermost_;
  std::vector<Column> columns_;
  std::vector<Point2> sorted_, hull_;
};

}  // namespace voxid
