// SPDX-License-Identifier: BSD-3-Clause
// The points of an object and what is asked of all of them, each coordinate in a row of its own: loops over a row are
// vectorised.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "even_choice.h"
#include "lateral.h"
#include "voxid/core/depth_view.h"

namespace voxid {

struct PointRows {
  std::array<std::int32_t, kMaxPoints> x, y, z;
  std::size_t size = 0;

  /// At most kMaxPoints.
  void add(const PointUm& p) {
    x[size] = p.x;
    y[size] = p.y;
    z[size++] = p.z;
  }
};

struct Range {
  std::int32_t least, most;
};
/// `size` is not zero.
Range rangeOf(const std::int32_t* row, std::size_t size);

/// Each number minus `corner`, shifted left and then right. Exact if no bit beyond 2^32 is set on the way.
void shiftRow(std::int32_t* row, std::size_t size, std::int32_t corner, int left, int right);

struct Moments {
  std::int64_t sum = 0, squares = 0;
};
/// Of numbers from 0 to 2^20 - 1.
Moments momentsOf(const std::int32_t* row, std::size_t size);

/// backProject() for many pixels of one camera: its division is a product with the focal length's reciprocal, put right
/// by the remainder.
class BackProjector {
 public:
  /// `camera` is valid.
  explicit BackProjector(const Camera& camera)
      : across_(camera.fx_q16, camera.cx_q16), down_(camera.fy_q16, camera.cy_q16) {}

  PointUm point(int u, int v, std::int32_t z_um) const {
    return {across_.lateralUm(u, z_um), down_.lateralUm(v, z_um), z_um};
  }

 private:
  class Axis {
   public:
    Axis(std::int32_t focal_q16, std::int32_t centre_q16)
        : focal_q16_(static_cast<std::uint64_t>(focal_q16)),
          reciprocal_q64_(UINT64_MAX / focal_q16_),
          centre_q16_(centre_q16) {}

    std::int32_t lateralUm(int pixel, std::int32_t z_um) const {
      const std::int64_t product = lateralProduct(pixel, centre_q16_, z_um);
      const std::uint64_t size = static_cast<std::uint64_t>(product < 0 ? -product : product) + focal_q16_ / 2;
      const auto um = static_cast<std::int64_t>(quotient(size));
      return saturatedUm(product < 0 ? -um : um);
    }

   private:
    // The reciprocal is short by less than 1, n / 2^64 is less than 1/2: the first quotient is right or one too small.
    std::uint64_t quotient(std::uint64_t n) const {
#ifdef __SIZEOF_INT128__
      __extension__ using Wide = unsigned __int128;
      const auto first = static_cast<std::uint64_t>(Wide{n} * reciprocal_q64_ >> 64);
      return first + (n - first * focal_q16_ >= focal_q16_);
#else
      return n / focal_q16_;
#endif
    }

    std::uint64_t focal_q16_, reciprocal_q64_;
    std::int32_t centre_q16_;
  };
  Axis across_, down_;
};

}  // namespace voxid
