// SPDX-License-Identifier: BSD-3-Clause
#include "looks.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "../core/vectorised.h"
#include "surface_painter.h"
#include "thinned_surface.h"

namespace voxid {
namespace {

using Eigen::Matrix3f;
using Eigen::Vector3f;

constexpr float kRadian = 3.14159265f / 180;
constexpr int kRings = PolarLook::kRings, kRolls = PolarLook::kRolls;

/// Widest ring, in radii of the points: a stick's half length is 1.7.
constexpr float kWidest = 2.2f;

std::uint8_t codeOfDepth(float in_radii) {
  return static_cast<std::uint8_t>(std::clamp(105 + 80 * in_radii, 10.0f, 200.0f) + 0.5f);
}

std::uint8_t lookAt(const Observation& seen, const Vector3f& point, const Vector3f& forward) {
  const float u = seen.grid.fx * point.x() / point.z() + seen.grid.cx + 0.5f;
  const float v = seen.grid.fy * point.y() / point.z() + seen.grid.cy + 0.5f;
  if (!(u >= 0 && v >= 0 && u < static_cast<float>(seen.grid.width) && v < static_cast<float>(seen.grid.height)))
    return PolarLook::kOutside;
  const std::size_t cell = seen.grid.at(static_cast<int>(u), static_cast<int>(v));
  if (!seen.object[cell]) return PolarLook::kOutside;
  return codeOfDepth((seen.point(cell) - seen.centroid_mm).dot(forward) / seen.radius_mm);
}

/// The camera at the distance that a thing on a table is seen from, three diagonals.
constexpr float kDistance = 3;

PixelGrid gridOfLooks() {
  constexpr int kSide = 64;
  PixelGrid grid;
  grid.width = grid.height = kSide;
  grid.fx = grid.fy = kSide * (kDistance - 0.5f);  // all of a ball of one diagonal
  grid.cx = grid.cy = (kSide - 1) / 2.0f;
  return grid;
}

Vector3f unitVector(const std::int16_t (&v)[3]) { return Vector3f(v[0], v[1], v[2]).normalized(); }

Placement lookFrom(const format::Direction& direction) {
  const Vector3f forward = -unitVector(direction.to_camera);
  const Vector3f right = forward.cross(unitVector(direction.up)).normalized();
  Placement pose;
  pose.rotation << right.transpose(), forward.cross(right).transpose(), forward.transpose();
  pose.translation = Vector3f(0, 0, kDistance);
  return pose;
}

/// What the painter drew, as if a camera had seen it.
Observation asObserved(const SurfacePainter& painter, const PixelGrid& grid) {
  Observation seen;
  seen.grid = grid;
  seen.depth_mm = painter.depth();
  seen.object.resize(grid.size());
  for (std::size_t cell = 0; cell < grid.size(); ++cell) {
    seen.object[cell] = painter.covers(cell);
    if (seen.object[cell]) seen.cells.push_back(cell);
  }
  measure(seen);
  return seen;
}

/// Rolls in whole registers; those beyond kRolls are nobody's.
constexpr std::size_t kRollsPadded = 96;
static_assert(kRings * kRolls * PolarLook::kClip <= 0xffff, "a difference fits 16 bits");
using Differences = std::array<std::uint16_t, kRollsPadded>;
/// A look's rings, each round and round, so that a turn is a place to begin.
using RoundAndRound = std::array<std::array<std::uint8_t, kRolls + kRollsPadded>, kRings>;

RoundAndRound roundAndRound(const PolarLook& look) {
  RoundAndRound rings;
  for (std::size_t ring = 0; ring < kRings; ++ring)
    for (std::size_t i = 0; i < rings[ring].size(); ++i) rings[ring][i] = look.value[ring][i % kRolls];
  return rings;
}

/// By roll: the look turned by so many steps against another, both ways outside the object alike.
VOXID_VECTORISED void compare(const PolarLook& a, const RoundAndRound& b, Differences& differences) {
  Differences sums{};
  for (std::size_t ring = 0; ring < kRings; ++ring) {
    for (std::size_t i = 0; i < kRolls; ++i) {
      const std::uint8_t left = a.value[ring][i];
      const std::uint8_t* const right = b[ring].data() + i;
      for (std::size_t roll = 0; roll < kRollsPadded; ++roll) {
        const std::uint8_t more = left > right[roll] ? left : right[roll],
                           less = left < right[roll] ? left : right[roll];
        const auto apart = static_cast<std::uint8_t>(more - less);
        sums[roll] = static_cast<std::uint16_t>(sums[roll] + (apart < PolarLook::kClip ? apart : PolarLook::kClip));
      }
    }
  }
  differences = sums;
}

/// A look and a roll, not yet a pose.
struct Rolled {
  int difference, roll;
  std::size_t look;
};

bool apart(int a, int b, int steps) {
  const int between = std::abs(a - b);
  return std::min(between, kRolls - between) >= steps;
}

/// The best two rolls of one look, at least 20 degrees apart.
void addRolls(const Differences& differences, std::size_t look, std::vector<Rolled>& out) {
  const auto smaller = [&](int a, int b) {
    return differences[static_cast<std::size_t>(a)] < differences[static_cast<std::size_t>(b)];
  };
  int first = 0;
  for (int roll = 1; roll < kRolls; ++roll) first = smaller(roll, first) ? roll : first;
  int second = -1;
  for (int roll = 0; roll < kRolls; ++roll) {
    if (apart(roll, first, 4) && (second < 0 || smaller(roll, second))) second = roll;
  }
  for (const int roll : {first, second}) out.push_back({differences[static_cast<std::size_t>(roll)], roll, look});
}

std::vector<Rolled> compareLooks(const AlignableModel::Looks& looks, const PolarLook& seen) {
  const RoundAndRound rings = roundAndRound(seen);
  Differences differences;
  std::vector<Rolled> rolled;
  for (std::size_t i = 0; i < looks.list.size(); ++i) {
    compare(looks.list[i].look, rings, differences);
    addRolls(differences, i, rolled);
  }
  std::stable_sort(rolled.begin(), rolled.end(),
                   [](const Rolled& a, const Rolled& b) { return a.difference < b.difference; });
  return rolled;
}

Placement poseOf(const ModelLook& look, int roll, const Observation& seen) {
  const Matrix3f turn = rotationFromAxisTo(seen.centroid_mm.normalized()) * rollBy(roll);
  Placement pose;
  pose.scale = seen.radius_mm / std::max(1e-6f, look.radius);
  pose.rotation = turn * look.rotation;
  pose.translation = seen.centroid_mm + turn * look.centre * pose.scale;
  return pose;
}

/// Whether two rotations are less than 14 degrees apart: 1 + 2 cos is the trace of the turn between.
bool nearlyEqual(const Matrix3f& a, const Matrix3f& b) {
  return a.cwiseProduct(b).sum() > 1 + 2 * std::cos(14 * kRadian);
}

/// Cosine and sine by step of a roll.
const std::array<Eigen::Vector2f, kRolls>& rolls() {
  static const std::array<Eigen::Vector2f, kRolls> all = [] {
    std::array<Eigen::Vector2f, kRolls> made;
    for (int step = 0; step < kRolls; ++step) made[static_cast<std::size_t>(step)] = rollBy(step).col(0).head<2>();
    return made;
  }();
  return all;
}

}  // namespace

Matrix3f rotationFromAxisTo(const Vector3f& to) {
  const Vector3f cross = Vector3f::UnitZ().cross(to);
  Matrix3f skew;
  skew << 0, -cross.z(), cross.y(), cross.z(), 0, -cross.x(), -cross.y(), cross.x(), 0;
  return Matrix3f::Identity() + skew + skew * skew / (1 + to.z());
}

Matrix3f rollBy(int step) {
  const float angle = static_cast<float>(step) * 360 / kRolls * kRadian;
  return Eigen::AngleAxisf(angle, Vector3f::UnitZ()).toRotationMatrix();
}

PolarLook polarLook(const Observation& seen) {
  const Matrix3f sight = rotationFromAxisTo(seen.centroid_mm.normalized());
  const Vector3f across = sight.col(0), down = sight.col(1), forward = sight.col(2);
  PolarLook look;
  for (std::size_t ring = 0; ring < kRings; ++ring) {
    const float radius_mm = kWidest * seen.radius_mm * std::sqrt((static_cast<float>(ring) + 0.5f) / kRings);
    for (std::size_t step = 0; step < kRolls; ++step) {
      const Eigen::Vector2f& roll = rolls()[step];
      const Vector3f point = seen.centroid_mm + radius_mm * (roll.x() * across + roll.y() * down);
      look.value[ring][step] = lookAt(seen, point, forward);
    }
  }
  return look;
}

std::vector<Start> findStarts(const AlignableModel::Looks& looks, const Observation& seen, int most) {
  std::vector<Start> starts;
  for (const Rolled& rolled : compareLooks(looks, polarLook(seen))) {
    if (static_cast<int>(starts.size()) == most) break;
    const Placement pose = poseOf(looks.list[rolled.look], rolled.roll, seen);
    const auto same = [&](const Start& start) { return nearlyEqual(start.pose.rotation, pose.rotation); };
    if (std::none_of(starts.begin(), starts.end(), same)) starts.push_back({pose, rolled.difference});
  }
  return starts;
}

AlignableModel::AlignableModel(ModelSurface surface, Span<const format::Direction> directions)
    : surface_(std::move(surface)), looks_(std::make_unique<Looks>()) {
  constexpr int kCells = 24;  // a cell is two pixels of the coarse observation of a thing that fills it
  constexpr std::size_t kFewTriangles = 500;
  if (surface_.triangles.size() > kFewTriangles) thinned_ = thinned(surface_, kCells);
  const PixelGrid grid = gridOfLooks();
  SurfacePainter painter;
  for (const format::Direction& direction : directions) {
    const Placement pose = lookFrom(direction);
    painter.draw(sketchSurface(), pose, grid);
    const Observation seen = asObserved(painter, grid);
    if (seen.cells.empty() || seen.radius_mm <= 0) continue;
    const Matrix3f unturn = rotationFromAxisTo(seen.centroid_mm.normalized()).transpose();
    looks_->list.push_back(
        {polarLook(seen), unturn * pose.rotation, unturn * (pose.translation - seen.centroid_mm), seen.radius_mm});
  }
}

AlignableModel::~AlignableModel() = default;

}  // namespace voxid
