// SPDX-License-Identifier: BSD-3-Clause
// The clock of a replayed device: shows one image after the other to the streams that run.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "config.h"

namespace voxid::replay {

/// What the control file has asked for. Outlives the opening and closing of the device.
class Faults {
 public:
  using Clock = std::chrono::steady_clock;
  enum class Effect { None, Hold, Skip, Corrupt, Noise };

  void stall(int ms);
  void drop(int frames);
  void corrupt(int frames);
  void noise(int frames);
  void setUnplugged(bool unplugged);
  bool unplugged() const;

  /// What happens to the frame that is due now. Hold: it stays due.
  Effect next();

 private:
  mutable std::mutex mutex_;
  Clock::time_point stalled_until_{};
  int drop_ = 0, corrupt_ = 0, noise_ = 0;
  bool unplugged_ = false;
};

/// A frame as the streams are to show it.
struct Shot {
  int image = 0;                   ///< which of the folder
  int index = 0;                   ///< 1, 2, ... since the start, dropped ones counted
  std::uint64_t timestamp_us = 0;  ///< since the start
  Faults::Effect effect = Faults::Effect::None;
};

class Viewer {
 public:
  virtual ~Viewer() = default;
  virtual void show(const Shot& shot) = 0;
};

/// Runs a thread while it has a viewer; the first viewer starts it at the first image.
class Player {
 public:
  Player(const Config& config, int images, Faults& faults, std::function<void()> on_end);
  ~Player();

  void add(Viewer* viewer);
  void remove(Viewer* viewer);  ///< after it returned, the viewer is not called

 private:
  void run();
  bool sleepUntil(Faults::Clock::time_point due);  ///< false: stop
  void showAll(const Shot& shot);

  const Config& config_;
  const int images_;
  Faults& faults_;
  const std::function<void()> on_end_;

  std::mutex mutex_;
  std::condition_variable wake_;
  std::vector<Viewer*> viewers_;
  bool stop_ = false;
  std::thread thread_;
};

}  // namespace voxid::replay
