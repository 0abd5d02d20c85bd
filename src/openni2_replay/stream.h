// SPDX-License-Identifier: BSD-3-Clause
// A depth or colour stream of a replayed folder.
#pragma once

#include "frame_folder.h"
#include "openni2_driver_api.h"
#include "player.h"

namespace voxid::replay {

/// The only mode that a folder offers for a sensor.
OniVideoMode videoMode(OniSensorType sensor, const Config& config, const FrameFolder& frames);

class ReplayStream : public oni::driver::StreamBase, private Viewer {
 public:
  ReplayStream(OniSensorType sensor, const Config& config, const FrameFolder& frames, Player& player);

  OniStatus start() override;
  void stop() override;
  OniStatus getProperty(int property, void* data, int* bytes) override;
  OniStatus setProperty(int property, const void* data, int bytes) override;
  OniBool isPropertySupported(int property) override;

 private:
  void show(const Shot& shot) override;
  cv::Mat pixelsOf(const Shot& shot) const;
  void describe(const Shot& shot, OniFrame& frame) const;
  float fov_rad(int length_px, double focal_px) const;

  const OniSensorType sensor_;
  const Config& config_;
  const FrameFolder& frames_;
  Player& player_;
  const OniVideoMode mode_;
};

}  // namespace voxid::replay
