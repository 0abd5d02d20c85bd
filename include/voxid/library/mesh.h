// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "voxid/core/status.h"

namespace voxid {

/// A triangle mesh as it was read: any unit, any orientation, not necessarily closed, faces inside out or not.
struct Mesh {
  using Vertex = std::array<float, 3>;
  using Triangle = std::array<std::uint32_t, 3>;

  std::vector<Vertex> vertices;
  std::vector<Triangle> triangles;  ///< numbers into `vertices`
};

/// The axis-aligned box round a mesh, in the mesh's unit.
struct MeshBox {
  std::array<double, 3> low{}, high{};

  std::array<double, 3> centre() const;
  double diagonal() const;
  double largestExtent() const;
};
MeshBox boxOf(const Mesh& mesh);

/// Leaves what can be rendered: triangles of finite vertices with an area, and the vertices that they use, in their
/// order. NothingFound if no triangle is left or the box has no finite size.
Status keepRenderable(Mesh& mesh);

}  // namespace voxid
