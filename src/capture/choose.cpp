// SPDX-License-Identifier: BSD-3-Clause
// Which device, which mode, which camera.
#include <cmath>
#include <cstdlib>

#include "parts.h"

namespace voxid {
namespace {

std::string seen(const std::vector<DeviceDescription>& devices) {
  const char* const replay = std::getenv("VOXID_REPLAY");
  if (devices.empty() && replay && *replay)
    return std::string("OpenNI2 sees no device, nor the replay of ") + replay +
           "; does the folder hold depth images, and LD_LIBRARY_PATH begin with the replay driver's folder?";
  if (devices.empty()) return "OpenNI2 sees no device; check the cable and the udev rules";
  std::string text = "OpenNI2 sees ";
  for (std::size_t i = 0; i < devices.size(); ++i) {
    text += (i ? ", #" : "#") + std::to_string(i + 1) + " " + devices[i].name + " " + devices[i].uri;
    if (!devices[i].serial.empty()) text += " serial " + devices[i].serial;
  }
  return text;
}

Result<DeviceDescription> chooseByNumber(const std::string& choice, const std::vector<DeviceDescription>& devices) {
  char* end = nullptr;
  const long number = std::strtol(choice.c_str() + 1, &end, 10);
  if (choice.size() < 2 || *end != '\0' || number < 1)
    return Status::badUse("device '" + choice +
                          "' is not understood; expected #1, #2, ..., a serial number, a URI or an .oni file");
  if (static_cast<std::size_t>(number) > devices.size())
    return Status::cannotDo("no device " + choice + ": " + seen(devices));
  return devices[static_cast<std::size_t>(number) - 1];
}

/// Smaller is better; negative: unusable.
int formatRank(Sensor sensor, openni::PixelFormat format) {
  if (sensor == Sensor::Colour) return format == openni::PIXEL_FORMAT_RGB888 ? 0 : -1;
  if (format == openni::PIXEL_FORMAT_DEPTH_1_MM) return 0;
  return format == openni::PIXEL_FORMAT_DEPTH_100_UM ? 1 : -1;
}

std::array<int, 3> rankOf(Sensor sensor, const openni::VideoMode& mode) {
  const int size = std::abs(mode.getResolutionX() * mode.getResolutionY() - 640 * 480);
  return {formatRank(sensor, mode.getPixelFormat()), size, std::abs(mode.getFps() - 30)};
}

double focal_px(double fov_rad, int length_px) {
  return std::round(length_px / (2 * std::tan(fov_rad / 2)) * 1000) / 1000;
}

}  // namespace

Result<DeviceDescription> chooseDevice(const std::string& choice, const std::vector<DeviceDescription>& devices) {
  if (choice.empty()) {
    if (devices.empty()) return Status::cannotDo("no device: " + seen(devices));
    return devices.front();
  }
  if (choice.front() == '#') return chooseByNumber(choice, devices);
  for (const DeviceDescription& device : devices)
    if (device.uri == choice || device.serial == choice) return device;
  return Status::cannotDo("no device with URI or serial number '" + choice + "': " + seen(devices));
}

const openni::VideoMode* chooseMode(Sensor sensor, const openni::Array<openni::VideoMode>& modes) {
  const openni::VideoMode* best = nullptr;
  for (int i = 0; i < modes.getSize(); ++i) {
    if (formatRank(sensor, modes[i].getPixelFormat()) < 0) continue;
    if (!best || rankOf(sensor, modes[i]) < rankOf(sensor, *best)) best = &modes[i];
  }
  return best;
}

Intrinsics intrinsicsFromFov(double horizontal_rad, double vertical_rad, int width_px, int height_px) {
  Intrinsics out;
  out.fx_px = focal_px(horizontal_rad, width_px);
  out.fy_px = vertical_rad > 0 ? focal_px(vertical_rad, height_px) : out.fx_px;
  out.cx_px = (width_px - 1) / 2.0;
  out.cy_px = (height_px - 1) / 2.0;
  return out;
}

}  // namespace voxid
