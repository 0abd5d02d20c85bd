// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/library/mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace voxid {
namespace {

bool finite(const Mesh::Vertex& v) { return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]); }

double doubledAreaSquared(const Mesh::Vertex& a, const Mesh::Vertex& b, const Mesh::Vertex& c) {
  double ab[3], ac[3];
  for (int i = 0; i < 3; ++i) {
    ab[i] = double{b[i]} - a[i];
    ac[i] = double{c[i]} - a[i];
  }
  const double x = ab[1] * ac[2] - ab[2] * ac[1], y = ab[2] * ac[0] - ab[0] * ac[2], z = ab[0] * ac[1] - ab[1] * ac[0];
  return x * x + y * y + z * z;
}

bool renderable(const Mesh& mesh, const Mesh::Triangle& t) {
  const std::size_t n = mesh.vertices.size();
  if (t[0] >= n || t[1] >= n || t[2] >= n) return false;
  const auto &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
  return finite(a) && finite(b) && finite(c) && doubledAreaSquared(a, b, c) > 0;
}

void dropUnusedVertices(Mesh& mesh) {
  constexpr std::uint32_t kUnused = 0xffffffff;
  std::vector<std::uint32_t> number(mesh.vertices.size(), kUnused);
  for (const auto& t : mesh.triangles) {
    for (const std::uint32_t corner : t) number[corner] = 0;
  }
  std::uint32_t used = 0;
  for (std::size_t i = 0; i < number.size(); ++i) {
    if (number[i] == kUnused) continue;
    mesh.vertices[used] = mesh.vertices[i];
    number[i] = used++;
  }
  mesh.vertices.resize(used);
  for (auto& t : mesh.triangles) {
    for (std::uint32_t& corner : t) corner = number[corner];
  }
}

}  // namespace

std::array<double, 3> MeshBox::centre() const {
  return {(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, (low[2] + high[2]) / 2};
}

double MeshBox::diagonal() const {
  double sum = 0;
  for (int i = 0; i < 3; ++i) sum += (high[i] - low[i]) * (high[i] - low[i]);
  return std::sqrt(sum);
}

double MeshBox::largestExtent() const { return std::max({high[0] - low[0], high[1] - low[1], high[2] - low[2]}); }

MeshBox boxOf(const Mesh& mesh) {
  MeshBox box;
  if (mesh.vertices.empty()) return box;
  box.low.fill(std::numeric_limits<double>::infinity());
  box.high.fill(-std::numeric_limits<double>::infinity());
  for (const auto& v : mesh.vertices) {
    for (int i = 0; i < 3; ++i) {
      box.low[i] = std::min(box.low[i], double{v[i]});
      box.high[i] = std::max(box.high[i], double{v[i]});
    }
  }
  return box;
}

Status keepRenderable(Mesh& mesh) {
  const auto useless = [&mesh](const Mesh::Triangle& t) { return !renderable(mesh, t); };
  const std::size_t found = mesh.triangles.size();
  mesh.triangles.erase(std::remove_if(mesh.triangles.begin(), mesh.triangles.end(), useless), mesh.triangles.end());
  if (mesh.triangles.empty()) {
    return Status::nothingFound(found == 0 ? "no triangle in it"
                                           : "no triangle of " + std::to_string(found) + " has an area");
  }
  dropUnusedVertices(mesh);
  const double diagonal = boxOf(mesh).diagonal();
  if (!std::isfinite(diagonal) || diagonal <= 0) return Status::nothingFound("its box has no finite size");
  return {};
}

}  // namespace voxid
