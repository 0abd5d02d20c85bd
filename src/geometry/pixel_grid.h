// SPDX-License-Identifier: BSD-3-Clause
// Every n-th pixel of a part of an image, as a pinhole camera of its own.
#pragma once

#include <Eigen/Core>
#include <cstddef>

namespace voxid {

struct PixelGrid {
  int width = 0, height = 0;             ///< cells
  float fx = 1, fy = 1, cx = 0, cy = 0;  ///< in cells

  std::size_t size() const { return static_cast<std::size_t>(width) * static_cast<std::size_t>(height); }
  std::size_t at(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(column);
  }
  int columnOf(std::size_t cell) const { return static_cast<int>(cell) % width; }
  int rowOf(std::size_t cell) const { return static_cast<int>(cell) / width; }
  bool contains(int column, int row) const { return column >= 0 && row >= 0 && column < width && row < height; }

  /// Through the cell's centre, one long along the optical axis.
  Eigen::Vector3f ray(std::size_t cell) const {
    return {(static_cast<float>(columnOf(cell)) - cx) / fx, (static_cast<float>(rowOf(cell)) - cy) / fy, 1};
  }
};

}  // namespace voxid
