// SPDX-License-Identifier: BSD-3-Clause
// A device that is read while somebody listens, and found again when it was lost.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>

#include "voxid/capture/capture_params.h"
#include "voxid/capture/device.h"

namespace voxid {

class LastingThread;

enum class CaptureState : std::uint8_t {
  Idle,     ///< nobody listens; the device is closed
  Opening,  ///< opened or about to be, no frame yet
  Running,
  Lost,    ///< absent, unplugged or stalled; tried again with growing delay
  Ended,   ///< the recording is over; starts anew with the next first listener
  Failed,  ///< trying again is no use (a damaged file, a device name that is none)
};
const char* nameOf(CaptureState state);  ///< "idle", ...

struct CaptureSnapshot {
  CaptureState state = CaptureState::Idle;
  std::string cause;             ///< Lost, Failed: the sentence
  std::string device;            ///< name and URI once opened
  std::string lacks;             ///< what is listened to and the device does not have, in a sentence; empty: nothing
  std::uint64_t frames = 0;      ///< handed over since construction
  std::uint64_t bad_frames = 0;  ///< thrown away: size not the mode's
  std::uint64_t reconnects = 0;  ///< outages that ended
  double last_frame_age_s = -1;  ///< -1: no frame yet
};

class CaptureLoop {
 public:
  struct Options {
    std::string device;  ///< as DeviceOptions
    bool colour = false;
    bool loop = false;  ///< a recording that ended begins again
  };
  /// Called on the loop's thread.
  struct Sink {
    std::function<void(const CaptureFrame&, const Intrinsics&)> frame;
    std::function<void(const std::string& sentence)> lost;  ///< once an outage or failure, not once a try
    std::function<void()> recovered;                        ///< first frame after an outage
  };

  /// Starts the thread, which waits for demand.
  CaptureLoop(Options options, Sink sink);
  ~CaptureLoop();  ///< joins; takes as long as a frame or the opening of the device
  CaptureLoop(const CaptureLoop&) = delete;
  CaptureLoop& operator=(const CaptureLoop&) = delete;

  /// What somebody listens to. Returns at once. Without demand the device is closed.
  void demand(bool depth, bool colour);
  void setParams(const CaptureParams& params);
  CaptureSnapshot snapshot() const;

 private:
  using Clock = std::chrono::steady_clock;
  enum class Outcome { NoDemand, Lost, Ended };

  void run();
  void serveDemand();
  Outcome readWhileWanted(Device& device, std::string& cause);
  Outcome lost(const char* how, const Device& device, std::string& cause) const;
  void handOver(const CaptureFrame& frame, const Intrinsics& intrinsics);
  void noteFrame();
  void awaitDue(std::uint64_t timestamp_us);
  void noteOutage(const Status& status);
  void awaitRetry();
  void awaitNoDemand();
  bool stalled(const Device& device) const;
  bool wanted() const { return !quit_ && (want_depth_ || want_colour_); }  ///< under mutex_
  void setState(CaptureState state, const std::string& cause = "");

  const Options options_;
  const Sink sink_;

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool quit_ = false, want_depth_ = false, want_colour_ = false;
  CaptureParams params_;
  CaptureSnapshot snapshot_;
  Clock::time_point last_frame_{}, watch_from_{};

  // The thread's own.
  bool in_outage_ = false;
  int retry_ms_ = 0;
  bool clock_set_ = false;
  Clock::time_point clock_start_{};
  std::uint64_t clock_first_us_ = 0, clock_last_us_ = 0;

  std::unique_ptr<LastingThread> thread_;
};

}  // namespace voxid
