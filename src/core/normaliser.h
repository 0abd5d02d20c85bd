// SPDX-License-Identifier: BSD-3-Clause
// Where the points of an object lie and how large it is, in integers that no input can overflow.
#pragma once

#include <algorithm>
#include <cstdint>

#include "voxid/core/depth_view.h"
#include "voxid/core/span.h"

namespace voxid {

struct Vector {
  std::int64_t x = 0, y = 0, z = 0;
};

inline std::int64_t squaredNorm(Vector v) { return v.x * v.x + v.y * v.y + v.z * v.z; }

/// floor(sqrt(n)), bit by bit from the highest that it can have.
constexpr std::uint64_t squareRoot(std::uint64_t n) {
  if (n == 0) return 0;
  std::uint64_t root = 0;
  for (std::uint64_t bit = std::uint64_t{1} << (63 - __builtin_clzll(n)) / 2; bit != 0; bit >>= 1) {
    if ((root | bit) * (root | bit) <= n) root |= bit;
  }
  return root;
}

/// A histogram's bin: round(255 sqrt(count / all)). 260,100 = (2 x 255)^2 leaves the half that rounding needs.
inline std::uint8_t rootOfShare(std::uint64_t count, std::uint64_t all) {
  return static_cast<std::uint8_t>((squareRoot(count * 260100 / all) + 1) / 2);
}

struct Box {
  PointUm least, most;
};

/// `points` is not empty.
inline Box boxOf(Span<const PointUm> points) {
  Box box{points[0], points[0]};
  for (const PointUm& p : points) {
    box.least = {std::min(box.least.x, p.x), std::min(box.least.y, p.y), std::min(box.least.z, p.z)};
    box.most = {std::max(box.most.x, p.x), std::max(box.most.y, p.y), std::max(box.most.z, p.z)};
  }
  return box;
}

inline bool isOnePoint(const Box& box) {
  return box.least.x == box.most.x && box.least.y == box.most.y && box.least.z == box.most.z;
}

/// Coordinates from the box's corner, shifted so that the largest extent lies in [2^19, 2^20): every later product is
/// bounded whatever the input, and a cloud twice as large gives the same numbers.
class Frame {
 public:
  explicit Frame(const Box& box) : corner_{box.least.x, box.least.y, box.least.z} {
    const Vector e = relative(box.most);
    for (std::int64_t largest = std::max({e.x, e.y, e.z}); largest >= kExtent; largest >>= 1) ++right_;
    for (std::int64_t largest = std::max({e.x, e.y, e.z}); largest < kExtent / 2; largest <<= 1) ++left_;
  }

  Vector of(const PointUm& p) const {
    const Vector r = relative(p);
    return {r.x << left_ >> right_, r.y << left_ >> right_, r.z << left_ >> right_};
  }

  /// Back to micrometres.
  Vector pointUm(Vector v) const { return {corner_.x + lengthUm(v.x), corner_.y + lengthUm(v.y), corner_.z + lengthUm(v.z)}; }
  std::int64_t lengthUm(std::int64_t length) const { return length << right_ >> left_; }

 private:
  static constexpr std::int64_t kExtent = 1 << 20;

  Vector relative(const PointUm& p) const { return {p.x - corner_.x, p.y - corner_.y, p.z - corner_.z}; }

  Vector corner_;
  int left_ = 0, right_ = 0;
};

/// Centroid and normaliser of points in a frame's coordinates: D = 3.4 root mean square distances from the centroid,
/// some 2.6 mean distances between points (doc/descriptor.md).
struct Normaliser {
  Vector centroid;
  std::uint64_t d = 0;
};

/// 65,536 points of squares below 3 x 2^40 sum to less than 2^58.
inline Normaliser normaliserOf(Span<const PointUm> points, const Frame& frame) {
  constexpr std::uint64_t kFactorSquaredPercent = 1156;
  const auto n = static_cast<std::int64_t>(points.size);
  Vector sum;
  std::int64_t squares = 0;
  for (const PointUm& point : points) {
    const Vector p = frame.of(point);
    sum = {sum.x + p.x, sum.y + p.y, sum.z + p.z};
    squares += squaredNorm(p);
  }
  const Vector c{sum.x / n, sum.y / n, sum.z / n};
  // sum of (p - c)^2 = sum of p^2 - 2 c sum of p + n c^2, exactly, for any c
  const std::int64_t about_centroid = squares - 2 * (c.x * sum.x + c.y * sum.y + c.z * sum.z) + n * squaredNorm(c);
  return {c, squareRoot(static_cast<std::uint64_t>(about_centroid / n) * kFactorSquaredPercent / 100)};
}

}  // namespace voxid
