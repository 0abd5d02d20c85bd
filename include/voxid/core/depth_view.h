// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

namespace voxid {

/// A point in the camera's optical frame (x right, y down, z forward), micrometres.
/// Any int32 is allowed; z is positive for a point that a camera saw.
struct PointUm {
  std::int32_t x = 0, y = 0, z = 0;
};

/// Pinhole intrinsics in 1/65536 pixel: integers, so that every machine back-projects alike.
/// Pixel (u, v) has its centre at u, v, as in ROS. fx and fy are positive.
struct Camera {
  std::int32_t fx_q16 = 0, fy_q16 = 0, cx_q16 = 0, cy_q16 = 0;

  /// From pixels, rounded to 1/65536 px. Values outside (0, 32767) for f, (-32768, 32767) for c make `valid()` false.
  static Camera fromPixels(double fx_px, double fy_px, double cx_px, double cy_px);
  bool valid() const { return fx_q16 > 0 && fy_q16 > 0; }
};

/// The point that pixel (u, v) sees at depth z_um (along the optical axis): x = (u - cx) z / fx, y alike. Exact 64-bit
/// integers for any z and |u|, |v| <= 32,767 (beyond, u and v are clamped), rounded to nearest, halves away from zero,
/// saturated to int32. The camera must be valid.
PointUm backProject(const Camera& camera, int u, int v, std::int32_t z_um);

/// How a depth image stores its numbers.
enum class DepthUnit : std::uint8_t {
  MillimetreU16,  ///< ROS 16UC1: 0 = no depth
  MetreF32,       ///< ROS 32FC1: NaN, infinity, zero and negative = no depth
};

/// An organised depth image that somebody else owns: no copy, valid as long as the owner keeps the pixels.
struct DepthView {
  const void* data = nullptr;
  int width_px = 0, height_px = 0;
  std::size_t row_bytes = 0;  ///< at least width_px times the size of a pixel
  DepthUnit unit = DepthUnit::MillimetreU16;
  Camera camera;

  /// Depth along the optical axis at (u, v), micrometres; 0 = none (also beyond 65.535 m). u, v must be inside the
  /// image.
  std::int32_t depthUm(int u, int v) const {
    return unit == DepthUnit::MillimetreU16 ? load<std::uint16_t>(u, v) * 1000 : metresToUm(load<float>(u, v));
  }
  bool empty() const { return data == nullptr || width_px <= 0 || height_px <= 0; }

 private:
  template <typename T>
  T load(int u, int v) const {
    T value;
    const auto* row = static_cast<const unsigned char*>(data) + static_cast<std::size_t>(v) * row_bytes;
    std::memcpy(&value, row + static_cast<std::size_t>(u) * sizeof(T), sizeof(T));  // rows may be unaligned
    return value;
  }
  static std::int32_t metresToUm(float z_m);
};

}  // namespace voxid
