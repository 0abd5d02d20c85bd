// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "depth_patch.h"
#include "voxid/core/span.h"

namespace voxid {

/// How an object's surface lies about its centroid, however the camera is rolled. Pairs of cells say what lies how far
/// from what; this says where. Two densities are laid over rings about the patch's middle: the surface, and the surface
/// times the outward lean of its normal. Along a ring each is a Fourier series, whose coefficients only change their
/// phase when the image turns: the product of two rings' coefficients of one order, one of them conjugate, does not
/// change at all, nor does its real part when the image is mirrored. doc/descriptor.md has formulas and ranges.
class PolarLayout {
 public:
  static constexpr int kRings = 6;         ///< 8 cells apart, the first at 4 cells from the middle
  static constexpr int kDirections = 128;  ///< of 360 degrees
  static constexpr int kOrders = 6;        ///< periods in a turn: 0 to 5
  static constexpr int kSeries = 2 * kRings;
  static constexpr int kNumbers = kOrders * kSeries * (kSeries + 1) / 2;

  /// Writes kNumbers bytes, order by order the pairs a <= b of the surface's rings and then the lean's:
  /// 128 + 254 sign(p) sqrt(|p|), p their product, the whole surface one.
  void measure(Span<const SurfaceCell> cells, std::uint8_t* numbers);

 private:
  using Density = std::array<std::int32_t, kDirections>;  // sixteenths of a cell
  struct Coefficient {
    std::int32_t cosine_q15, sine_q15;
  };

  void add(const SurfaceCell& cell);
  Coefficient coefficient(int series, int order, std::int64_t whole) const;

  std::array<Density, kSeries> densities_;
};

}  // namespace voxid
