// SPDX-License-Identifier: BSD-3-Clause
// An OpenNI2 device: camera, recording (.oni) or replayed folder. Blocking, no thread of its own.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "voxid/core/status.h"

namespace voxid {

/// A device that OpenNI2 sees now.
struct DeviceDescription {
  std::string uri;  ///< as its driver names it; changes with the USB port
  std::string vendor;
  std::string name;
  std::string serial;  ///< empty if the device has none or is in use
};

/// Opens each for a moment to read its serial number. In the order that "#1", "#2", ... counts. An empty list is Ok.
Result<std::vector<DeviceDescription>> listDevices();

/// Which of the listed devices `choice` names: "" the first, "#N" the N-th (from 1), a URI, or a serial number.
/// CannotDo with a sentence saying what was looked for and what is there; BadUse for "#" without a number.
Result<DeviceDescription> chooseDevice(const std::string& choice, const std::vector<DeviceDescription>& devices);

/// Pinhole intrinsics, pixels; the centre of pixel (u, v) is at u, v.
struct Intrinsics {
  double fx_px = 0, fy_px = 0, cx_px = 0, cy_px = 0;
};

/// OpenNI2 knows a field of view (radians) and puts the optical axis in the middle of the image. The focal length is
/// rounded to 1/1000 px: a float holds no more, and 525 comes back as 525. A vertical field of 0 means square pixels.
Intrinsics intrinsicsFromFov(double horizontal_rad, double vertical_rad, int width_px, int height_px);

enum class Sensor : std::uint8_t { Depth, Colour };

/// A frame that OpenNI2 owns, valid during the call that hands it over.
struct CaptureFrame {
  Sensor sensor = Sensor::Depth;
  const void* data = nullptr;
  int width_px = 0, height_px = 0;
  std::size_t row_bytes = 0;       ///< of `data`
  std::uint64_t timestamp_us = 0;  ///< the device's clock: any zero, the same for depth and colour
  int index = 0;                   ///< counts up; a gap is a lost frame
  bool tenth_mm = false;           ///< depth in 0.1 mm, converted by copyTo
  bool mirrored = false;           ///< left and right are exchanged, put right by copyTo

  /// 2 for depth (uint16 millimetres, 0 = none), 3 for colour (RGB).
  int pixelBytes() const { return sensor == Sensor::Depth ? 2 : 3; }
  /// Writes the frame as millimetres or RGB, not mirrored: the only copy between driver and message.
  /// `to` has height_px rows of `to_row_bytes` >= width_px * pixelBytes().
  void copyTo(void* to, std::size_t to_row_bytes) const;
};

struct DeviceOptions {
  /// "" (first), "#N", serial number, URI (`replay:/folder?fps=30` too), or the path of an .oni file.
  std::string device;
  /// Prepare for colour: depth is registered to it where the device can.
  bool colour = false;
  /// A recording begins again after its last frame (its timestamps and indices too).
  bool repeat = false;
};

class Device {
 public:
  /// Opens the device and picks its modes. Depth: 1 mm before 0.1 mm, then the size nearest to 640 x 480, then the rate
  /// nearest to 30/s; formats that hold no depth (shifts, packed) are refused. Mirroring is switched off where the
  /// device can. CannotDo: no such device, no depth. Damaged: an .oni that is empty or cut. BadUse: "#x".
  static Result<std::unique_ptr<Device>> open(const DeviceOptions& options);
  ~Device();  ///< stops and closes; also after a disconnect
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  const DeviceDescription& description() const;
  bool isFile() const;
  bool hasColour() const;  ///< opened with colour, and the device has it
  Intrinsics intrinsics(Sensor sensor) const;
  int width_px(Sensor sensor) const;
  int height_px(Sensor sensor) const;
  int fps(Sensor sensor) const;

  /// Starts or stops streams; those that run already go on undisturbed.
  Status setStreaming(bool depth, bool colour);

  enum class Event : std::uint8_t {
    Frame,         ///< `frame` is valid until the next call
    Nothing,       ///< no frame within the time
    BadFrame,      ///< a frame came whose size is not the mode's; it was thrown away
    Disconnected,  ///< the device is gone; only destroying it makes sense
    End,           ///< a recording, or a replay without loop, has shown its last frame
  };
  /// Waits for the next frame of any running stream, at most timeout_ms. A recording gives every frame, one after the
  /// other, as fast as it is read; its end is known by its count of frames, or, where the file holds none, by silence.
  Event wait(int timeout_ms, CaptureFrame& frame);

  struct Parts;  ///< OpenNI2's own objects, for this library's sources
  Parts& parts() { return *parts_; }

 private:
  explicit Device(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace voxid
