// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/geometry/symmetry.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace voxid {
namespace {

using Eigen::Matrix3f;
using Eigen::Vector3f;

constexpr float kTurn = 2 * 3.14159265358979f;
/// The grid of samples covers a cube of this half width; the model's box has a diagonal of 1.
constexpr float kHalfWidth = 0.5f;
constexpr float kFar = 2;

float areaOf(const ModelSurface& surface, const std::array<std::uint32_t, 3>& t) {
  const Vector3f& a = surface.vertices[t[0]];
  return 0.5f * (surface.vertices[t[1]] - a).cross(surface.vertices[t[2]] - a).norm();
}

/// A point of the triangle, evenly for x and y in 0 to 1.
Vector3f pointIn(const ModelSurface& surface, const std::array<std::uint32_t, 3>& t, float x, float y) {
  if (x + y > 1) {
    x = 1 - x;
    y = 1 - y;
  }
  const Vector3f& a = surface.vertices[t[0]];
  return a + x * (surface.vertices[t[1]] - a) + y * (surface.vertices[t[2]] - a);
}

float fraction(double x) { return static_cast<float>(x - std::floor(x)); }

std::vector<Vector3f> drawSamples(const ModelSurface& surface, int count, float phase) {
  std::vector<double> area_before{0};
  for (const auto& t : surface.triangles) area_before.push_back(area_before.back() + areaOf(surface, t));
  std::vector<Vector3f> points;
  if (!(area_before.back() > 0)) return points;
  std::size_t triangle = 0;
  for (int i = 0; i < count; ++i) {
    const double area = area_before.back() * (i + 0.5) / count;
    while (triangle + 1 < surface.triangles.size() && area_before[triangle + 1] < area) ++triangle;
    // The plastic number's sequence fills the square evenly.
    const float x = fraction(phase + i * 0.7548776662466927), y = fraction(phase + i * 0.5698402909980532);
    points.push_back(pointIn(surface, surface.triangles[triangle], x, y));
  }
  return points;
}

Matrix3f turnAbout(int axis, float angle) { return Eigen::AngleAxisf(angle, Vector3f::Unit(axis)).toRotationMatrix(); }

/// Whether a surface lies where it lay, by samples of it.
class SelfComparison {
 public:
  explicit SelfComparison(const ModelSurface& surface) : some_(surface, 400, 0.37f), all_(surface, 8000) {
    for (const Vector3f& p : some_.points()) most_ += all_.distanceTo(p);
    most_ += 0.006f * static_cast<float>(some_.points().size());
  }
  bool alike(const Matrix3f& turn) const {
    float sum = 0;
    for (const Vector3f& p : some_.points()) {
      sum += all_.distanceTo(turn * p);
      if (sum >= most_) return false;  // most turns end after a few points
    }
    return true;
  }
  bool empty() const { return some_.points().empty(); }

 private:
  SurfaceSamples some_, all_;
  float most_ = 0;  ///< sum of the distances of a turn that is alike
};

/// Angles that no fold of a few divides: alike at all of them means alike at any.
bool alikeAtAnyAngle(const SelfComparison& self, int axis) {
  constexpr float kShares[] = {0.031f, 0.083f, 0.139f, 0.271f, 0.389f};
  return std::all_of(std::begin(kShares), std::end(kShares),
                     [&](float share) { return self.alike(turnAbout(axis, share * kTurn)); });
}

std::uint8_t foldsAbout(const SelfComparison& self, int axis) {
  if (alikeAtAnyAngle(self, axis)) return 0;
  for (const int folds : {12, 10, 9, 8, 7, 6, 5, 4, 3, 2}) {
    if (self.alike(turnAbout(axis, kTurn / static_cast<float>(folds)))) return static_cast<std::uint8_t>(folds);
  }
  return 1;
}

}  // namespace

SurfaceSamples::SurfaceSamples(const ModelSurface& surface, int count, float phase) {
  const std::vector<Vector3f> drawn = drawSamples(surface, count, phase);
  const auto cell = [&](const Vector3f& p) {
    return static_cast<std::size_t>((cellOf(p.z()) * kSide + cellOf(p.y())) * kSide + cellOf(p.x()));
  };
  cell_starts_.assign(kSide * kSide * kSide + 1, 0);
  for (const Vector3f& p : drawn) ++cell_starts_[cell(p) + 1];
  for (std::size_t i = 1; i < cell_starts_.size(); ++i) cell_starts_[i] += cell_starts_[i - 1];
  std::vector<std::uint32_t> next(cell_starts_.begin(), cell_starts_.end() - 1);
  points_.resize(drawn.size());
  for (const Vector3f& p : drawn) points_[next[cell(p)]++] = p;
}

int SurfaceSamples::cellOf(float x) const {
  const float cell = (x + kHalfWidth) * (kSide / (2 * kHalfWidth));
  return static_cast<int>(std::clamp(cell, 0.0f, static_cast<float>(kSide - 1)));
}

float SurfaceSamples::nearestInCell(const Vector3f& point, int x, int y, int z, float best) const {
  if (std::min({x, y, z}) < 0 || std::max({x, y, z}) >= kSide) return best;
  const auto cell = static_cast<std::size_t>((z * kSide + y) * kSide + x);
  for (std::uint32_t i = cell_starts_[cell]; i < cell_starts_[cell + 1]; ++i)
    best = std::min(best, (points_[i] - point).squaredNorm());
  return best;
}

float SurfaceSamples::nearestInRing(const Vector3f& point, const std::array<int, 3>& centre, int ring,
                                    float best) const {
  for (int z = -ring; z <= ring; ++z) {
    for (int y = -ring; y <= ring; ++y) {
      const bool face = std::abs(z) == ring || std::abs(y) == ring;
      for (int x = -ring; x <= ring; x += face || ring == 0 ? 1 : 2 * ring) {
        best = nearestInCell(point, centre[0] + x, centre[1] + y, centre[2] + z, best);
      }
    }
  }
  return best;
}

float SurfaceSamples::distanceTo(const Vector3f& point) const {
  if (points_.empty()) return kFar;
  const std::array<int, 3> centre{cellOf(point.x()), cellOf(point.y()), cellOf(point.z())};
  const Vector3f inside = point.cwiseMax(-kHalfWidth).cwiseMin(kHalfWidth);
  const float outside = (point - inside).norm(), cell_width = 2 * kHalfWidth / kSide;
  float best = kFar * kFar;
  for (int ring = 0; ring < kSide; ++ring) {
    // Whatever lies in this ring and further out is at least so far from the cube's nearest point.
    const float least = std::max(outside, static_cast<float>(ring - 1) * cell_width);
    if (best <= least * least) break;
    best = nearestInRing(point, centre, ring, best);
  }
  return std::sqrt(best);
}

Symmetry findSymmetry(const ModelSurface& surface) {
  const SelfComparison self(surface);
  Symmetry symmetry;
  if (self.empty()) return symmetry;
  for (int axis = 0; axis < 3; ++axis) symmetry.folds[static_cast<std::size_t>(axis)] = foldsAbout(self, axis);
  return symmetry;
}

std::vector<Matrix3f> turnsOf(const Symmetry& symmetry) {
  constexpr int kStepsOfAnyAngle = 72;
  std::vector<Matrix3f> turns{Matrix3f::Identity()};
  for (int axis = 0; axis < 3; ++axis) {
    const int folds = symmetry.anyAngle(axis) ? kStepsOfAnyAngle : symmetry.folds[static_cast<std::size_t>(axis)];
    for (int i = 1; i < folds; ++i)
      turns.push_back(turnAbout(axis, kTurn * static_cast<float>(i) / static_cast<float>(folds)));
  }
  const std::size_t alone = turns.size();
  for (int axis = 0; axis < 3; ++axis) {
    if (symmetry.folds[static_cast<std::size_t>(axis)] % 2 != 0) continue;  // 0, any angle, is even too
    const Matrix3f half = turnAbout(axis, kTurn / 2);
    for (std::size_t i = 1; i < alone; ++i) turns.push_back(turns[i] * half);
  }
  return turns;
}

}  // namespace voxid
