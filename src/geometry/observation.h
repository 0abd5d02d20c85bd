// SPDX-License-Identifier: BSD-3-Clause
// What the camera saw of an object, thinned out and cut from the image.
#pragma once

#include <cstdint>
#include <vector>

#include "pixel_grid.h"
#include "voxid/geometry/alignment.h"

namespace voxid {

struct Observation {
  PixelGrid grid;
  std::vector<float> depth_mm;       ///< of whatever is seen there; 0: nothing
  std::vector<std::uint8_t> object;  ///< 1: a pixel of the object with depth
  std::vector<std::size_t> cells;    ///< the object's, ascending
  std::vector<int> nearest;          ///< of a cell outside the object: as nearestSet, the first of equally near ones
  Eigen::Vector3f centroid_mm{0, 0, 0};  ///< of the object's points
  float radius_mm = 0;                   ///< root mean square distance from it

  Eigen::Vector3f point(std::size_t cell) const { return grid.ray(cell) * depth_mm[cell]; }

  static constexpr int kReach = 10;                         ///< cells
  static constexpr int kFar = (kReach + 1) * (kReach + 1);  ///< squared
};

/// Takes every n-th row and column, so that about `pixels` of the object's are left, and a margin round it. Fills in
/// the grid, `depth_mm` and `object` alone.
void cutOut(const ObservedObject& object, int pixels, Observation& out);

/// The same, and the rest.
void observe(const ObservedObject& object, int pixels, Observation& out);

/// Whether what is seen there hides what is drawn: it is nearer by so much, and does not deny it. 0: nothing is seen.
constexpr float kHidingMm = 12;
constexpr bool hides(float seen_mm, float drawn_mm) { return seen_mm > 0 && seen_mm < drawn_mm - kHidingMm; }

/// Centroid and radius of the object's cells.
void measure(Observation& observation);

/// The nearest set cell within Observation::kReach columns and rows, some one of equally near ones; -1 if none is.
template <typename IsSet>
int nearestSet(const PixelGrid& grid, std::size_t from, IsSet is_set) {
  const int u = grid.columnOf(from), v = grid.rowOf(from);
  int best = -1, best_squared = Observation::kFar;
  const auto look = [&](int x, int y) {
    if (!grid.contains(x, y) || !is_set(grid.at(x, y))) return;
    const int squared = (x - u) * (x - u) + (y - v) * (y - v);
    if (squared >= best_squared) return;
    best_squared = squared;
    best = static_cast<int>(grid.at(x, y));
  };
  for (int r = 1; r <= Observation::kReach && r * r < best_squared; ++r) {  // squares, one round another
    for (int i = -r; i <= r; ++i) {
      look(u + i, v - r);
      look(u + i, v + r);
    }
    for (int i = 1 - r; i < r; ++i) {
      look(u - r, v + i);
      look(u + r, v + i);
    }
  }
  return best;
}

}  // namespace voxid
