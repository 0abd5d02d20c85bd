// SPDX-License-Identifier: BSD-3-Clause
#include <atomic>
#include <cstdio>
#include <cstring>
#include <list>
#include <memory>

#include "control.h"
#include "stream.h"

namespace voxid::replay {
namespace {

constexpr auto kControlPeriod = std::chrono::milliseconds(10);

void copyText(char (&to)[ONI_MAX_STR], const std::string& from) { to[from.copy(to, ONI_MAX_STR - 1)] = '\0'; }

OniDeviceInfo infoOf(const Config& config) {
  OniDeviceInfo info = {};
  copyText(info.uri, config.uri);
  copyText(info.vendor, "voxid");
  copyText(info.name, "Replay");
  return info;
}

/// A folder that has been presented to OpenNI2.
struct Folder {
  explicit Folder(Config c) : config(std::move(c)), info(infoOf(config)), control(config.control) {}

  const Config config;
  const OniDeviceInfo info;
  ControlFile control;
  Faults faults;
  std::unique_ptr<FrameFolder> frames;  // decoded when first opened
  Faults::Clock::time_point replug_at = Faults::Clock::time_point::max();
};

class ReplayDevice : public oni::driver::DeviceBase {
 public:
  ReplayDevice(Folder& folder, std::function<void()> on_end)
      : folder_(folder), player_(folder.config, folder.frames->size(), folder.faults, std::move(on_end)) {
    addSensor(ONI_SENSOR_DEPTH);
    if (folder.frames->hasColour()) addSensor(ONI_SENSOR_COLOR);
    for (int i = 0; i < sensors_count_; ++i) sensors_[i].pSupportedVideoModes = &modes_[i];
  }

  OniStatus getSensorInfoList(OniSensorInfo** sensors, int* count) override {
    *sensors = sensors_;
    *count = sensors_count_;
    return ONI_STATUS_OK;
  }

  oni::driver::StreamBase* createStream(OniSensorType sensor) override {
    const bool offered = sensor == ONI_SENSOR_DEPTH || (sensor == ONI_SENSOR_COLOR && folder_.frames->hasColour());
    return offered ? new ReplayStream(sensor, folder_.config, *folder_.frames, player_) : nullptr;
  }
  void destroyStream(oni::driver::StreamBase* stream) override { delete stream; }

  OniStatus getProperty(int property, void* data, int* bytes) override {
    if (property == ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION && *bytes >= static_cast<int>(sizeof registration_))
      return std::memcpy(data, &registration_, sizeof registration_), ONI_STATUS_OK;
    if (property != ONI_DEVICE_PROPERTY_SERIAL_NUMBER || *bytes <= static_cast<int>(folder_.config.serial.size()))
      return ONI_STATUS_NOT_SUPPORTED;
    std::memcpy(data, folder_.config.serial.c_str(), folder_.config.serial.size() + 1);
    *bytes = static_cast<int>(folder_.config.serial.size() + 1);
    return ONI_STATUS_OK;
  }

  OniStatus setProperty(int property, const void* data, int bytes) override {
    if (property != ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION || bytes != static_cast<int>(sizeof registration_))
      return ONI_STATUS_NOT_SUPPORTED;
    std::memcpy(&registration_, data, sizeof registration_);
    return ONI_STATUS_OK;
  }

  OniBool isPropertySupported(int property) override {
    return property == ONI_DEVICE_PROPERTY_SERIAL_NUMBER || property == ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION;
  }
  OniBool isImageRegistrationModeSupported(OniImageRegistrationMode) override {
    return TRUE;
  }  // the folder's images match

 private:
  void addSensor(OniSensorType sensor) {
    modes_[sensors_count_] = videoMode(sensor, folder_.config, *folder_.frames);
    sensors_[sensors_count_++] = {sensor, 1, nullptr};
  }

  Folder& folder_;
  OniVideoMode modes_[2] = {};
  OniSensorInfo sensors_[2] = {};
  int sensors_count_ = 0;
  OniImageRegistrationMode registration_ = ONI_IMAGE_REGISTRATION_OFF;
  Player player_;
};

class ReplayDriver : public oni::driver::DriverBase {
 public:
  explicit ReplayDriver(OniDriverServices* services) : DriverBase(services) {}
  ~ReplayDriver() override { stopControl(); }

  OniStatus initialize(oni::driver::DeviceConnectedCallback connected,
                       oni::driver::DeviceDisconnectedCallback disconnected,
                       oni::driver::DeviceStateChangedCallback changed, void* cookie) override {
    DriverBase::initialize(connected, disconnected, changed, cookie);
    std::vector<std::string> problems;
    for (const Config& config : configsFromEnvironment(problems)) present(config);
    for (const std::string& problem : problems) tell(problem);
    control_thread_ = std::thread(&ReplayDriver::watchControl, this);
    return ONI_STATUS_OK;
  }

  OniStatus tryDevice(const char* uri) override {
    std::string problem;
    const std::optional<Config> config = configFromUri(uri, problem);
    if (!config) return say(problem), ONI_STATUS_ERROR;
    return find(uri) || present(*config) ? ONI_STATUS_OK : ONI_STATUS_ERROR;
  }

  oni::driver::DeviceBase* deviceOpen(const char* uri, const char*) override {
    Folder* folder = find(uri);
    if (!folder || folder->faults.unplugged() || !load(*folder)) return nullptr;
    return new ReplayDevice(*folder, [this, folder] { deviceStateChanged(&folder->info, ONI_DEVICE_STATE_EOF); });
  }
  void deviceClose(oni::driver::DeviceBase* device) override { delete device; }
  void shutdown() override { stopControl(); }

 private:
  void say(const std::string& problem) {
    if (problem.empty()) return;
    getServices().errorLoggerAppend("%s", problem.c_str());
    getServices().log(3, __FILE__, __LINE__, "VoxidReplay", problem.c_str());
  }

  /// Also where nobody asks OpenNI2 what it has to complain of: a device is there, but not as it was meant to be.
  void tell(const std::string& problem) {
    std::fprintf(stderr, "voxid replay: %s\n", problem.c_str());
    say(problem);
  }

  bool present(const Config& config) {
    if (config.uri.size() >= ONI_MAX_STR) return say(config.uri + " is longer than OpenNI2's 255 characters"), false;
    if (findFrames(config.folder).empty())
      return say(config.folder + " holds no depth images (*_depth.png, depth/*.png, *.png)"), false;
    std::unique_lock<std::mutex> lock(mutex_);
    folders_.emplace_back(config);
    const OniDeviceInfo& info = folders_.back().info;
    lock.unlock();
    deviceConnected(&info);
    return true;
  }

  Folder* find(const std::string& uri) {
    std::lock_guard<std::mutex> lock(mutex_);
    for (Folder& folder : folders_)
      if (folder.config.uri == uri) return &folder;
    return nullptr;
  }

  bool load(Folder& folder) {
    if (folder.frames) return true;
    auto frames = std::make_unique<FrameFolder>();
    std::string problem;
    if (!frames->load(folder.config.folder, problem)) return say(problem), false;
    folder.frames = std::move(frames);
    return true;
  }

  void watchControl() {
    std::unique_lock<std::mutex> lock(mutex_);
    while (!wake_.wait_for(lock, kControlPeriod, [this] { return stop_; })) {
      for (Folder& folder : folders_) {  // a list: what others append meanwhile moves nothing
        lock.unlock();
        obeyAll(folder);
        lock.lock();
      }
    }
  }

  void stopControl() {
    {
      std::lock_guard<std::mutex> lock(mutex_);
      stop_ = true;
    }
    wake_.notify_all();
    if (control_thread_.joinable()) control_thread_.join();
  }

  void obeyAll(Folder& folder) {
    if (Faults::Clock::now() >= folder.replug_at) replug(folder);
    for (const std::string& line : folder.control.poll()) {
      Command command;
      if (parseCommand(line, command))
        obey(folder, command);
      else
        say("control: '" + line +
            "' is no command; expected unplug [MS], replug, stall MS, drop N, corrupt N, noise N");
    }
  }

  void obey(Folder& folder, const Command& command) {
    switch (command.kind) {
      case Command::Kind::Unplug:
        return unplug(folder, command.amount);
      case Command::Kind::Replug:
        return replug(folder);
      case Command::Kind::Stall:
        return folder.faults.stall(command.amount);
      case Command::Kind::Drop:
        return folder.faults.drop(command.amount);
      case Command::Kind::Corrupt:
        return folder.faults.corrupt(command.amount);
      case Command::Kind::Noise:
        return folder.faults.noise(command.amount);
    }
  }

  void unplug(Folder& folder, int ms) {
    if (ms > 0) folder.replug_at = Faults::Clock::now() + std::chrono::milliseconds(ms);
    if (folder.faults.unplugged()) return;
    folder.faults.setUnplugged(true);
    deviceDisconnected(&folder.info);
  }

  void replug(Folder& folder) {
    folder.replug_at = Faults::Clock::time_point::max();
    if (!folder.faults.unplugged()) return;
    folder.faults.setUnplugged(false);
    deviceConnected(&folder.info);
  }

  std::mutex mutex_;
  std::condition_variable wake_;
  std::list<Folder> folders_;
  bool stop_ = false;
  std::thread control_thread_;
};

}  // namespace
}  // namespace voxid::replay

ONI_EXPORT_DRIVER(voxid::replay::ReplayDriver)
