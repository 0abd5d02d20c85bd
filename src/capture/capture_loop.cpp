// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/capture/capture_loop.h"

#include <algorithm>

#include "lasting_thread.h"
#include "parts.h"

namespace voxid {
namespace {

constexpr int kSlice_ms = 50;  // how soon a change of demand is noticed
constexpr auto kLongestPause = std::chrono::seconds(1);

std::string titleOf(const Device& device) { return device.description().name + " " + device.description().uri; }

bool worthRetrying(const Status& status) { return status.kind == Status::Kind::CannotDo; }

}  // namespace

const char* nameOf(CaptureState state) {
  switch (state) {
    case CaptureState::Idle:
      return "idle";
    case CaptureState::Opening:
      return "opening";
    case CaptureState::Running:
      return "running";
    case CaptureState::Lost:
      return "lost";
    case CaptureState::Ended:
      return "ended";
    case CaptureState::Failed:
      return "failed";
  }
  return "unknown";
}

CaptureLoop::CaptureLoop(Options options, Sink sink)
    : options_(std::move(options)),
      sink_(std::move(sink)),
      thread_(std::make_unique<LastingThread>([this] { run(); })) {}

CaptureLoop::~CaptureLoop() {
  {
    std::lock_guard<std::mutex> lock(mutex_);
    quit_ = true;
  }
  changed_.notify_all();
  thread_.reset();
}

void CaptureLoop::demand(bool depth, bool colour) {
  {
    std::lock_guard<std::mutex> lock(mutex_);
    want_depth_ = depth;
    want_colour_ = colour && options_.colour;
  }
  changed_.notify_all();
}

void CaptureLoop::setParams(const CaptureParams& params) {
  {
    std::lock_guard<std::mutex> lock(mutex_);
    params_ = params;
  }
  changed_.notify_all();
}

CaptureSnapshot CaptureLoop::snapshot() const {
  std::lock_guard<std::mutex> lock(mutex_);
  CaptureSnapshot copy = snapshot_;
  if (copy.frames > 0) copy.last_frame_age_s = std::chrono::duration<double>(Clock::now() - last_frame_).count();
  return copy;
}

void CaptureLoop::setState(CaptureState state, const std::string& cause) {
  std::lock_guard<std::mutex> lock(mutex_);
  snapshot_.state = state;
  snapshot_.cause = cause;
}

void CaptureLoop::run() {
  // From the first demand on: OpenNI2 keeps looking for devices between two tries, and does not start anew for each.
  Result<std::shared_ptr<OpenNiSession>> session = Status{};
  for (;;) {
    {
      std::unique_lock<std::mutex> lock(mutex_);
      snapshot_.state = CaptureState::Idle;
      snapshot_.cause.clear();
      snapshot_.lacks.clear();
      changed_.wait(lock, [this] { return quit_ || wanted(); });
      if (quit_) return;
      retry_ms_ = 0;
    }
    in_outage_ = false;
    if (!session.value) session = OpenNiSession::begin();
    serveDemand();
  }
}

/// Opens and reads, again and again, until nobody listens.
void CaptureLoop::serveDemand() {
  for (;;) {
    if (!in_outage_) setState(CaptureState::Opening);
    Result<std::unique_ptr<Device>> device = Device::open({options_.device, options_.colour, options_.loop});
    std::string cause;
    const Outcome outcome = device.ok() ? readWhileWanted(*device.value, cause) : Outcome::Lost;
    const bool opened = device.ok();
    device.value.reset();  // a recording at its end keeps a processor busy until it is closed
    if (outcome == Outcome::NoDemand) return;
    if (outcome == Outcome::Ended && options_.loop) continue;
    if (outcome == Outcome::Ended) {
      setState(CaptureState::Ended);
      return awaitNoDemand();
    }
    const Status status = opened ? Status::cannotDo(cause) : device.status;
    noteOutage(status);
    if (!worthRetrying(status)) return awaitNoDemand();
    awaitRetry();
    std::lock_guard<std::mutex> lock(mutex_);
    if (!wanted()) return;
  }
}

CaptureLoop::Outcome CaptureLoop::lost(const char* how, const Device& device, std::string& cause) const {
  cause = "device " + titleOf(device) + " " + how;
  return Outcome::Lost;
}

CaptureLoop::Outcome CaptureLoop::readWhileWanted(Device& device, std::string& cause) {
  const Intrinsics intrinsics[] = {device.intrinsics(Sensor::Depth),
                                   device.hasColour() ? device.intrinsics(Sensor::Colour) : Intrinsics{}};
  {
    std::lock_guard<std::mutex> lock(mutex_);
    snapshot_.device = titleOf(device);
    watch_from_ = Clock::now();
  }
  clock_set_ = false;
  bool depth_runs = false, colour_runs = false;
  for (CaptureFrame frame;;) {
    bool depth, colour;
    {
      std::lock_guard<std::mutex> lock(mutex_);
      if (!wanted()) return Outcome::NoDemand;
      depth = want_depth_;
      colour = want_colour_ && device.hasColour();
      snapshot_.lacks = colour == want_colour_ ? "" : "device " + titleOf(device) + " has no colour stream";
      if (!depth && !colour) watch_from_ = Clock::now();  // nothing that could stall
    }
    if (depth != depth_runs || colour != colour_runs) {
      const Status status = device.setStreaming(depth, colour);
      if (!status.ok()) return cause = status.sentence, Outcome::Lost;
      depth_runs = depth;
      colour_runs = colour;
    }
    switch (device.wait(kSlice_ms, frame)) {
      case Device::Event::Disconnected:
        return lost("was disconnected", device, cause);
      case Device::Event::End:
        return Outcome::Ended;
      case Device::Event::BadFrame: {
        std::lock_guard<std::mutex> lock(mutex_);
        ++snapshot_.bad_frames;
        break;
      }
      case Device::Event::Frame:
        if (device.isFile()) awaitDue(frame.timestamp_us);
        handOver(frame, intrinsics[static_cast<int>(frame.sensor)]);
        break;
      case Device::Event::Nothing:
        break;
    }
    if (stalled(device)) return lost("has stalled: no frame came within stall_ms", device, cause);
  }
}

bool CaptureLoop::stalled(const Device& device) const {
  std::lock_guard<std::mutex> lock(mutex_);
  return !device.isFile() && Clock::now() - watch_from_ > std::chrono::milliseconds(params_.stall_ms);
}

void CaptureLoop::handOver(const CaptureFrame& frame, const Intrinsics& intrinsics) {
  noteFrame();
  if (in_outage_ && sink_.recovered) sink_.recovered();
  in_outage_ = false;
  sink_.frame(frame, intrinsics);
}

void CaptureLoop::noteFrame() {
  std::lock_guard<std::mutex> lock(mutex_);
  last_frame_ = watch_from_ = Clock::now();
  snapshot_.state = CaptureState::Running;
  snapshot_.cause.clear();
  ++snapshot_.frames;
  if (in_outage_) ++snapshot_.reconnects;
  retry_ms_ = 0;
}

/// Plays a recording at the rate of its own clock.
void CaptureLoop::awaitDue(std::uint64_t timestamp_us) {
  if (!clock_set_ || timestamp_us < clock_last_us_) {  // first frame, or first of the next round
    clock_set_ = true;
    clock_start_ = Clock::now();
    clock_first_us_ = timestamp_us;
  }
  clock_last_us_ = timestamp_us;
  const auto since_first = std::chrono::microseconds(static_cast<std::int64_t>(timestamp_us - clock_first_us_));
  const auto due = std::min(clock_start_ + since_first, Clock::now() + kLongestPause);
  std::unique_lock<std::mutex> lock(mutex_);
  changed_.wait_until(lock, due, [this] { return !wanted(); });
}

void CaptureLoop::noteOutage(const Status& status) {
  setState(worthRetrying(status) ? CaptureState::Lost : CaptureState::Failed, status.sentence);
  if (!in_outage_ && sink_.lost) sink_.lost(status.sentence);
  in_outage_ = true;
}

/// Waits no longer than the parameters say, also if they change meanwhile.
void CaptureLoop::awaitRetry() {
  std::unique_lock<std::mutex> lock(mutex_);
  const auto begin = Clock::now();
  retry_ms_ = retry_ms_ == 0 ? params_.retry_first_ms : 2 * retry_ms_;
  do {
    retry_ms_ = std::min(retry_ms_, std::max(params_.retry_first_ms, params_.retry_most_ms));
  } while (wanted() &&
           changed_.wait_until(lock, begin + std::chrono::milliseconds(retry_ms_)) == std::cv_status::no_timeout);
}

void CaptureLoop::awaitNoDemand() {
  std::unique_lock<std::mutex> lock(mutex_);
  changed_.wait(lock, [this] { return !wanted(); });
}

}  // namespace voxid
