// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/core/depth_view.h"

#include <cmath>

#include "lateral.h"

namespace voxid {
namespace {

constexpr double kQ16 = 65536.0;
constexpr double kMaxDepthUm = 65535000.0;

bool isFocal(double px) { return px * kQ16 >= 0.5 && px < kMaxPixel; }
bool isCentre(double px) { return px > -kMaxPixel - 1 && px < kMaxPixel; }
std::int32_t toQ16(double px) { return static_cast<std::int32_t>(std::lround(px * kQ16)); }

std::int32_t lateralUm(int pixel, std::int32_t centre_q16, std::int32_t focal_q16, std::int32_t z_um) {
  const std::int64_t product = lateralProduct(pixel, centre_q16, z_um);
  const std::int64_t half = focal_q16 / 2;
  return saturatedUm((product < 0 ? product - half : product + half) / focal_q16);
}

}  // namespace

Camera Camera::fromPixels(double fx_px, double fy_px, double cx_px, double cy_px) {
  if (!isFocal(fx_px) || !isFocal(fy_px) || !isCentre(cx_px) || !isCentre(cy_px)) return {};
  return {toQ16(fx_px), toQ16(fy_px), toQ16(cx_px), toQ16(cy_px)};
}

PointUm backProject(const Camera& camera, int u, int v, std::int32_t z_um) {
  return {lateralUm(u, camera.cx_q16, camera.fx_q16, z_um), lateralUm(v, camera.cy_q16, camera.fy_q16, z_um), z_um};
}

std::int32_t DepthView::metresToUm(float z_m) {
  const double z_um = static_cast<double>(z_m) * 1e6 + 0.5;
  return z_um >= 1.0 && z_um < kMaxDepthUm + 1.0 ? static_cast<std::int32_t>(z_um) : 0;  // false for NaN
}

}  // namespace voxid
