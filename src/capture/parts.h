// SPDX-License-Identifier: BSD-3-Clause
// What a Device is made of; only this folder sees OpenNI2's header.
#pragma once

#include <OpenNI.h>

#include <array>
#include <atomic>
#include <chrono>
#include <memory>

#include "voxid/capture/device.h"

namespace voxid {

/// OpenNI2 is initialised while one of these lives.
class OpenNiSession {
 public:
  static Result<std::shared_ptr<OpenNiSession>> begin();
  ~OpenNiSession();
};

/// OpenNI2's last complaint without line ends; empty if it has none.
std::string openNiComplaint();

/// One sensor of an open device.
struct SensorStream {
  openni::VideoStream stream;
  openni::VideoMode mode;
  bool mirrored = false;
  bool running = false;
  int frames_in_file = -1;  ///< -1: not a file, or the file does not say
  int last_index = 0;
  bool at_end = false;

  bool open() const { return stream.isValid(); }
};

struct Device::Parts : openni::OpenNI::DeviceDisconnectedListener, openni::OpenNI::DeviceStateChangedListener {
  std::shared_ptr<OpenNiSession> session;
  openni::Device device;
  std::array<SensorStream, 2> sensors;  ///< by Sensor
  DeviceDescription description;
  bool repeat = false;
  std::atomic<bool> disconnected{false}, ended{false};
  openni::VideoFrameRef frame;
  std::chrono::steady_clock::time_point last_frame;

  ~Parts() override;
  SensorStream& operator[](Sensor sensor) { return sensors[static_cast<std::size_t>(sensor)]; }
  void onDeviceDisconnected(const openni::DeviceInfo* info) override;
  void onDeviceStateChanged(const openni::DeviceInfo* info, openni::DeviceState state) override;
};

/// The mode to read a sensor with, by the rules of Device::open; nullptr if none will do.
const openni::VideoMode* chooseMode(Sensor sensor, const openni::Array<openni::VideoMode>& modes);

}  // namespace voxid
