// SPDX-License-Identifier: BSD-3-Clause
// What a depth camera would see of a model in an object's stead.
#pragma once

#include <cstdint>
#include <vector>

#include "observation.h"
#include "surface_painter.h"
#include "voxid/geometry/alignment.h"

namespace voxid {

class DrawnObject {
 public:
  /// See Aligner::drawn. `seen`: by cutOut(), every pixel.
  ObservedObject draw(const ModelSurface& surface, const Placement& pose, const Observation& seen);

 private:
  bool onOutline(const PixelGrid& grid, std::size_t cell) const;

  SurfacePainter painter_;
  std::vector<std::uint16_t> depth_mm_;
  std::vector<std::uint32_t> pixels_;
};

}  // namespace voxid
