// SPDX-License-Identifier: BSD-3-Clause
// Where the points of an object lie and how large it is, in integers that no input can overflow.
#pragma once

#include <algorithm>
#include <cstdint>

#include "point_rows.h"
#include "voxid/core/depth_view.h"

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
inline Box boxOf(const PointRows& points) {
  const Range x = rangeOf(points.x.data(), points.size), y = rangeOf(points.y.data(), points.size),
              z = rangeOf(points.z.data(), points.size);
  return {{x.least, y.least, z.least}, {x.most, y.most, z.most}};
}

inline bool isOnePoint(const Box& box) {
  return box.least.x == box.most.x && box.least.y == box.most.y && box.least.z == box.most.z;
}

/// Coordinates from the box's corner, shifted so that the largest extent lies in [2^19, 2^20): every later product is
/// bounded whatever the input, and a cloud twice as large gives the same numbers.
class Frame {
 public:
  explicit Frame(const Box& box) : corner_(box.least) {
    const Vector e{std::int64_t{box.most.x} - corner_.x, std::int64_t{box.most.y} - corner_.y,
                   std::int64_t{box.most.z} - corner_.z};
    for (std::int64_t largest = std::max({e.x, e.y, e.z}); largest >= kExtent; largest >>= 1) ++right_;
    for (std::int64_t largest = std::max({e.x, e.y, e.z}); largest < kExtent / 2; largest <<= 1) ++left_;
  }

  /// Brings the box's points into the frame.
  void enter(PointRows& points) const {
    shiftRow(points.x.data(), points.size, corner_.x, left_, right_);
    shiftRow(points.y.data(), points.size, corner_.y, left_, right_);
    shiftRow(points.z.data(), points.size, corner_.z, left_, right_);
  }

  /// Back to micrometres.
  Vector pointUm(Vector v) const {
    return {corner_.x + lengthUm(v.x), corner_.y + lengthUm(v.y), corner_.z + lengthUm(v.z)};
  }
  std::int64_t lengthUm(std::int64_t length) const { return length << right_ >> left_; }

 private:
  static constexpr std::int64_t kExtent = 1 << 20;

  PointUm corner_;
  int left_ = 0, right_ = 0;
};

/// Centroid and normaliser of points in a frame's coordinates: D = 3.4 root mean square distances from the centroid,
/// some 2.6 mean distances between points (doc/descriptor.md).
struct Normaliser {
  Vector centroid;
  std::uint64_t d = 0;
};

/// 65,536 points of squares below 3 x 2^40 sum to less than 2^58.
inline Normaliser normaliserOf(const PointRows& in_frame) {
  constexpr std::uint64_t kFactorSquaredPercent = 1156;
  const auto n = static_cast<std::int64_t>(in_frame.size);
  const Moments x = momentsOf(in_frame.x.data(), in_frame.size), y = momentsOf(in_frame.y.data(), in_frame.size),
                z = momentsOf(in_frame.z.data(), in_frame.size);
  const Vector sum{x.sum, y.sum, z.sum};
  const std::int64_t squares = x.squares + y.squares + z.squares;
  const Vector c{sum.x / n, sum.y / n, sum.z / n};
  // sum of (p - c)^2 = sum of p^2 - 2 c sum of p + n c^2, exactly, for any c
  const std::int64_t about_centroid = squares - 2 * (c.x * sum.x + c.y * sum.y + c.z * sum.z) + n * squaredNorm(c);
  return {c, squareRoot(static_cast<std::uint64_t>(about_centroid / n) * kFactorSquaredPercent / 100)};
}

}  // namespace voxid
