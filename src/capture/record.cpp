// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/capture/record.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdio>
#include <cstring>
#include <thread>

#include "oni_file.h"
#include "parts.h"

namespace voxid {
namespace {

using Clock = std::chrono::steady_clock;
constexpr int kSlice_ms = 100;  // how soon `stop` is noticed

constexpr auto kDrainStep = std::chrono::milliseconds(150);  // longer than a frame takes to compress
constexpr int kMostDrainSteps = 100;

double secondsSince(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

bool done(const RecordLimits& limits, const RecordReport& report) {
  return (limits.stop && *limits.stop) || (limits.frames > 0 && report.frames >= limits.frames) ||
         (limits.seconds > 0 && report.seconds >= limits.seconds);
}

/// Reads until a limit; the recorder takes its own copy of each frame.
Status follow(Device& device, const RecordLimits& limits, RecordReport& report,
              const std::function<void(int)>& progress) {
  const auto start = Clock::now();
  auto last_frame = start;
  CaptureFrame frame;
  while (!done(limits, report)) {
    const Device::Event event = device.wait(kSlice_ms, frame);
    report.seconds = secondsSince(start);
    if (event == Device::Event::End) return {};
    if (event == Device::Event::Disconnected)
      return Status::cannotDo("device " + device.description().uri + " vanished after frame " +
                              std::to_string(report.frames));
    if (event == Device::Event::Frame)
      last_frame = Clock::now();
    else if (secondsSince(last_frame) * 1000 > limits.silence_ms)
      return Status::cannotDo("device " + device.description().uri + " has sent no frame for " +
                              std::to_string(limits.silence_ms) + " ms");
    if (event != Device::Event::Frame || frame.sensor != Sensor::Depth) continue;
    ++report.frames;
    if (progress) progress(report.frames);
  }
  return {};
}

/// Asked beforehand: OpenNI2's recorder crashes on a file that cannot be written.
Status checkWritable(const std::string& path) {
  const int fd = open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (fd < 0) return Status::cannotDo(path + " cannot be written: " + std::strerror(errno));
  close(fd);
  return {};
}

Status startRecorder(openni::Recorder& recorder, Device& device, const std::string& path) {
  const Status writable = checkWritable(path);
  if (!writable.ok()) return writable;
  bool ok = recorder.create(path.c_str()) == openni::STATUS_OK;
  for (SensorStream& sensor : device.parts().sensors)
    if (ok && sensor.open()) ok = recorder.attach(sensor.stream, false) == openni::STATUS_OK;
  if (ok && recorder.start() == openni::STATUS_OK) return {};
  return Status::cannotDo(path + " cannot be recorded to (" + openNiComplaint() +
                          "); is the folder there and writable?");
}

long long fileBytes(const std::string& path) {
  struct stat info = {};
  return stat(path.c_str(), &info) == 0 ? static_cast<long long>(info.st_size) : 0;
}

/// The recorder's thread takes its orders late: frames that come before it has begun, or wait to be compressed at
/// Recorder::stop(), are forgotten. Lets it write what it has.
void awaitWritten(const std::string& path) {
  long long before = -1;
  for (int i = 0; i < kMostDrainSteps && before != fileBytes(path); ++i) {
    before = fileBytes(path);
    std::this_thread::sleep_for(kDrainStep);
  }
}

/// Depth frames that a reader will find; the proof that there is one.
Status countFrames(const std::string& path, int& frames) {
  const auto written = Device::open({path});
  if (!written.ok()) return Status::cannotDo("the recording cannot be read back: " + written.status.sentence);
  frames = written.value->parts()[Sensor::Depth].frames_in_file;
  return {};
}

Status publishFile(const std::string& beside, const std::string& path) {
  const auto length = oniLength(beside);
  if (!length.ok()) return length.status;
  const int fd = open(beside.c_str(), O_WRONLY | O_CLOEXEC);
  const bool safe = fd >= 0 && ftruncate(fd, length.value) == 0 && fsync(fd) == 0;
  if (fd >= 0) close(fd);
  if (safe && std::rename(beside.c_str(), path.c_str()) == 0) return {};
  return Status::cannotDo(path + " cannot be written; is the disk full or the folder read-only?");
}

}  // namespace

Status record(Device& device, const std::string& path, const RecordLimits& limits, RecordReport& report,
              const std::function<void(int)>& progress) {
  const std::string beside = path + ".part-" + std::to_string(getpid());
  openni::Recorder recorder;
  Status status = startRecorder(recorder, device, beside);
  if (status.ok()) awaitWritten(beside);
  if (status.ok()) status = device.setStreaming(true, device.hasColour());
  if (status.ok()) status = follow(device, limits, report, progress);
  (void)device.setStreaming(false, false);
  if (report.frames > 0) awaitWritten(beside);
  recorder.stop();
  recorder.destroy();
  if (status.ok() && report.frames == 0)
    status = Status::cannotDo("nothing was recorded: no frame came before the stop");
  Status written;
  if (report.frames > 0) written = countFrames(beside, report.frames);
  if (report.frames > 0 && written.ok()) written = publishFile(beside, path);
  std::remove(beside.c_str());
  return status.ok() ? written : status;
}

}  // namespace voxid
