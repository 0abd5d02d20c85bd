// SPDX-License-Identifier: BSD-3-Clause
#include "thinned_surface.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace voxid {
namespace {

using Corners = std::array<std::uint32_t, 3>;

/// Number of the cell that holds a point; the model's box lies within half a diagonal of the origin.
std::int32_t cellOf(const Eigen::Vector3f& point, int cells) {
  std::int32_t cell = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const float along = (point[axis] + 0.5f) * static_cast<float>(cells);
    cell = cell * cells + std::clamp(static_cast<int>(std::floor(along)), 0, cells - 1);
  }
  return cell;
}

/// The number that each vertex gets, in the order of first use; fills `means`.
std::vector<std::uint32_t> joinVertices(const std::vector<Eigen::Vector3f>& vertices, int cells,
                                        std::vector<Eigen::Vector3f>& means) {
  std::map<std::int32_t, std::uint32_t> numbers;
  std::vector<std::uint32_t> joined;
  std::vector<float> counts;
  for (const Eigen::Vector3f& vertex : vertices) {
    const auto next = static_cast<std::uint32_t>(means.size());
    const auto [at, is_new] = numbers.try_emplace(cellOf(vertex, cells), next);
    if (is_new) {
      means.emplace_back(0, 0, 0);
      counts.push_back(0);
    }
    means[at->second] += vertex;
    counts[at->second] += 1;
    joined.push_back(at->second);
  }
  for (std::size_t i = 0; i < means.size(); ++i) means[i] /= counts[i];
  return joined;
}

bool hasArea(const Corners& t) { return t[0] != t[1] && t[1] != t[2] && t[2] != t[0]; }

}  // namespace

ModelSurface thinned(const ModelSurface& surface, int cells) {
  ModelSurface thin;
  const std::vector<std::uint32_t> joined = joinVertices(surface.vertices, cells, thin.vertices);
  for (const Corners& corners : surface.triangles) {
    Corners t{joined[corners[0]], joined[corners[1]], joined[corners[2]]};
    std::sort(t.begin(), t.end());  // two-sided: which way round does not matter
    if (hasArea(t)) thin.triangles.push_back(t);
  }
  std::sort(thin.triangles.begin(), thin.triangles.end());
  thin.triangles.erase(std::unique(thin.triangles.begin(), thin.triangles.end()), thin.triangles.end());
  return thin;
}

}  // namespace voxid
