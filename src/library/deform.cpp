// SPDX-License-Identifier: BSD-3-Clause
#include "deform.h"

#include <array>

namespace voxid {
namespace {

constexpr float kMostStretch = 1.5f, kMostTaper = 0.3f;

float drawStretch(Random& random) {
  const float stretch = random.between(1, kMostStretch);
  return random.chance(0.5f) ? stretch : 1 / stretch;
}

}  // namespace

Mesh deformed(Mesh mesh, Random& random) {
  const MeshBox box = boxOf(mesh);
  std::array<float, 3> stretch;
  for (float& s : stretch) s = drawStretch(random);
  const auto along = static_cast<std::size_t>(random.below(3));
  const std::size_t across = (along + 1 + static_cast<std::size_t>(random.below(2))) % 3;
  const float taper = random.between(-kMostTaper, kMostTaper);
  const auto middle = [&](std::size_t axis) { return static_cast<float>((box.low[axis] + box.high[axis]) / 2); };
  const float half_length = static_cast<float>(box.high[along] - box.low[along]) / 2;
  for (Mesh::Vertex& v : mesh.vertices) {
    const float place = half_length > 0 ? (v[along] - middle(along)) / half_length : 0;  // -1 to 1
    v[across] = middle(across) + (v[across] - middle(across)) * (1 + taper * place);
    for (std::size_t axis = 0; axis < 3; ++axis) v[axis] *= stretch[axis];
  }
  return mesh;
}

}  // namespace voxid
