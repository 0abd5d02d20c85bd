// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/capture/device.h"

#include <sys/stat.h>

#include <algorithm>
#include <thread>

#include "oni_file.h"
#include "parts.h"

namespace voxid {
namespace {

constexpr auto kFileSilence = std::chrono::seconds(1);
constexpr auto kPlayerParks = std::chrono::milliseconds(30);
constexpr Sensor kSensors[] = {Sensor::Depth, Sensor::Colour};

std::string serialOf(openni::Device& device) {
  char text[256] = {};
  int bytes = sizeof text - 1;
  const bool known = device.getProperty(openni::DEVICE_PROPERTY_SERIAL_NUMBER, text, &bytes) == openni::STATUS_OK;
  return known ? text : "";
}

std::vector<DeviceDescription> enumerate() {
  openni::Array<openni::DeviceInfo> infos;
  openni::OpenNI::enumerateDevices(&infos);
  std::vector<DeviceDescription> devices;
  for (int i = 0; i < infos.getSize(); ++i)
    devices.push_back({infos[i].getUri(), infos[i].getVendor(), infos[i].getName(), ""});
  return devices;
}

void addSerials(std::vector<DeviceDescription>& devices) {
  for (DeviceDescription& description : devices) {
    openni::Device device;
    if (device.open(description.uri.c_str()) == openni::STATUS_OK) description.serial = serialOf(device);
  }
}

bool namesFile(const std::string& choice) {
  struct stat info = {};
  const bool named_so = choice.size() > 4 && choice.compare(choice.size() - 4, 4, ".oni") == 0;
  return named_so ||
         (choice.find(':') == std::string::npos && stat(choice.c_str(), &info) == 0 && S_ISREG(info.st_mode));
}

std::string inParentheses(const std::string& text) { return text.empty() ? "" : " (" + text + ")"; }

/// What to give to OpenNI2's open().
Result<DeviceDescription> resolve(const std::string& choice) {
  if (namesFile(choice)) {
    const Status file = oniLength(choice).status;
    if (!file.ok()) return file;
    return DeviceDescription{choice, "", "", ""};
  }
  std::vector<DeviceDescription> devices = enumerate();
  Result<DeviceDescription> chosen = chooseDevice(choice, devices);
  if (chosen.ok() || choice.empty() || choice.front() == '#') return chosen;
  if (choice.find(':') != std::string::npos)
    return DeviceDescription{choice, "", "", ""};  // a driver may know how to make it
  addSerials(devices);
  return chooseDevice(choice, devices);
}

Status openNative(openni::Device& device, const std::string& uri) {
  if (device.open(uri.c_str()) == openni::STATUS_OK) return {};
  const std::string why = inParentheses(openNiComplaint());
  if (namesFile(uri))
    return Status::damaged(uri + " is no recording that OpenNI2 can read" + why + "; record it again");
  return Status::cannotDo("device " + uri + " cannot be opened" + why +
                          "; is it plugged in, and does no other program use it?");
}

/// Frame after frame; the rate is the reader's affair. Repeat is always on: without it OpenNI2's player thread spins at
/// the end of the file, and walks over streams that are being destroyed.
void setUpPlayback(openni::Device& device) {
  openni::PlaybackControl* playback = device.getPlaybackControl();
  if (!playback) return;
  playback->setRepeatEnabled(true);
  playback->setSpeed(-1);
}

/// OpenNI2's player thread looks at a file's streams without a lock, except while it holds a frame that nobody has
/// asked for. Brings it there, so that the streams can be destroyed.
void parkPlayer(Device::Parts& parts) {
  SensorStream& depth = parts[Sensor::Depth];
  if (!depth.open() || !parts.device.isFile()) return;
  if (!depth.running) depth.running = depth.stream.start() == openni::STATUS_OK;
  std::this_thread::sleep_for(kPlayerParks);
}

void setUpStream(SensorStream& sensor, openni::Device& device) {
  sensor.stream.setMirroringEnabled(false);
  sensor.mirrored = sensor.stream.getMirroringEnabled();
  openni::PlaybackControl* playback = device.getPlaybackControl();
  if (playback) sensor.frames_in_file = playback->getNumberOfFrames(sensor.stream);
}

Status openSensor(Device::Parts& parts, Sensor which) {
  const std::string name = which == Sensor::Depth ? "depth" : "colour";
  const std::string& uri = parts.description.uri;
  SensorStream& sensor = parts[which];
  const openni::SensorType type = which == Sensor::Depth ? openni::SENSOR_DEPTH : openni::SENSOR_COLOR;
  const openni::SensorInfo* info = parts.device.getSensorInfo(type);
  if (!info) return Status::cannotDo("device " + uri + " has no " + name + " stream");
  const openni::VideoMode* mode = chooseMode(which, info->getSupportedVideoModes());
  if (!mode)
    return Status::cannotDo(
        "device " + uri + " offers no " + name + " mode that can be read; expected " +
        (which == Sensor::Depth ? "depth in 1 mm or 0.1 mm, found only shifts or packed formats" : "RGB888"));
  if (sensor.stream.create(parts.device, type) != openni::STATUS_OK)
    return Status::cannotDo("device " + uri + ": its " + name + " stream cannot be opened" +
                            inParentheses(openNiComplaint()));
  if (!parts.device.isFile() && sensor.stream.setVideoMode(*mode) != openni::STATUS_OK)
    return Status::cannotDo("device " + uri + " refuses its own " + name + " mode" + inParentheses(openNiComplaint()));
  sensor.mode = sensor.stream.getVideoMode();
  setUpStream(sensor, parts.device);
  return {};
}

void registerDepth(openni::Device& device) {
  if (device.isImageRegistrationModeSupported(openni::IMAGE_REGISTRATION_DEPTH_TO_COLOR))
    device.setImageRegistrationMode(openni::IMAGE_REGISTRATION_DEPTH_TO_COLOR);
}

void describe(Device::Parts& parts) {
  const openni::DeviceInfo& info = parts.device.getDeviceInfo();
  parts.description = {info.getUri(), info.getVendor(), info.getName(), serialOf(parts.device)};
}

Status setRunning(SensorStream& sensor, bool wanted, const std::string& uri) {
  if (!sensor.open() || sensor.running == wanted) return {};
  if (!wanted)
    sensor.stream.stop();
  else if (sensor.stream.start() != openni::STATUS_OK)
    return Status::cannotDo("device " + uri + " does not start" + inParentheses(openNiComplaint()));
  sensor.running = wanted;
  return {};
}

bool fileEnded(const Device::Parts& parts) {
  const auto& sensors = parts.sensors;
  if (std::all_of(sensors.begin(), sensors.end(), [](const SensorStream& s) { return !s.running || s.at_end; }))
    return true;
  return std::chrono::steady_clock::now() - parts.last_frame > kFileSilence;
}

/// True if the frame belongs to the next round already.
bool noteEnd(SensorStream& sensor, int index) {
  const bool next_round = index <= sensor.last_index;
  sensor.last_index = std::max(index, sensor.last_index);
  sensor.at_end = next_round || (sensor.frames_in_file > 0 && index >= sensor.frames_in_file);
  return next_round;
}

bool sizeIsRight(const openni::VideoFrameRef& frame, const openni::VideoMode& mode) {
  return frame.getWidth() == mode.getResolutionX() && frame.getHeight() == mode.getResolutionY() &&
         frame.getDataSize() >= frame.getHeight() * frame.getStrideInBytes();
}

CaptureFrame borrow(const openni::VideoFrameRef& from, Sensor which, const SensorStream& sensor) {
  CaptureFrame frame;
  frame.sensor = which;
  frame.data = from.getData();
  frame.width_px = from.getWidth();
  frame.height_px = from.getHeight();
  frame.row_bytes = static_cast<std::size_t>(from.getStrideInBytes());
  frame.timestamp_us = from.getTimestamp();
  frame.index = from.getFrameIndex();
  frame.tenth_mm = from.getVideoMode().getPixelFormat() == openni::PIXEL_FORMAT_DEPTH_100_UM;
  frame.mirrored = sensor.mirrored;
  return frame;
}

/// The sensor with a new frame; nullptr: none came.
SensorStream* waitForStream(Device::Parts& parts, int timeout_ms) {
  openni::VideoStream* streams[2];
  SensorStream* owners[2];
  int count = 0, ready = -1;
  for (SensorStream& sensor : parts.sensors)
    if (sensor.running && !sensor.at_end) owners[count] = &sensor, streams[count++] = &sensor.stream;
  if (count == 0) return nullptr;
  const openni::Status status = openni::OpenNI::waitForAnyStream(streams, count, &ready, std::max(1, timeout_ms));
  return status == openni::STATUS_OK && ready >= 0 ? owners[ready] : nullptr;
}

}  // namespace

Device::Parts::~Parts() {
  openni::OpenNI::removeDeviceDisconnectedListener(this);
  openni::OpenNI::removeDeviceStateChangedListener(this);
  frame.release();
  parkPlayer(*this);
  for (SensorStream& sensor : sensors) {
    if (sensor.running) sensor.stream.stop();
    sensor.stream.destroy();
  }
  device.close();
}

void Device::Parts::onDeviceDisconnected(const openni::DeviceInfo* info) {
  if (description.uri == info->getUri()) disconnected = true;
}

void Device::Parts::onDeviceStateChanged(const openni::DeviceInfo* info, openni::DeviceState state) {
  if (state == openni::DEVICE_STATE_EOF && description.uri == info->getUri()) ended = true;
}

Result<std::vector<DeviceDescription>> listDevices() {
  const auto session = OpenNiSession::begin();
  if (!session.ok()) return session.status;
  std::vector<DeviceDescription> devices = enumerate();
  addSerials(devices);
  return devices;
}

Device::Device(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
Device::~Device() = default;

Result<std::unique_ptr<Device>> Device::open(const DeviceOptions& options) {
  auto session = OpenNiSession::begin();
  if (!session.ok()) return session.status;
  const Result<DeviceDescription> chosen = resolve(options.device);
  if (!chosen.ok()) return chosen.status;

  auto parts = std::make_unique<Parts>();
  parts->session = std::move(session.value);
  parts->description = chosen.value;
  parts->repeat = options.repeat;
  openni::OpenNI::addDeviceDisconnectedListener(parts.get());
  openni::OpenNI::addDeviceStateChangedListener(parts.get());
  Status status = openNative(parts->device, chosen.value.uri);
  if (!status.ok()) return status;
  describe(*parts);
  setUpPlayback(parts->device);
  if (options.colour) registerDepth(parts->device);
  status = openSensor(*parts, Sensor::Depth);
  if (!status.ok()) return status;
  if (options.colour && parts->device.hasSensor(openni::SENSOR_COLOR)) {
    status = openSensor(*parts, Sensor::Colour);
    if (!status.ok()) return status;
  }
  return std::unique_ptr<Device>(new Device(std::move(parts)));
}

const DeviceDescription& Device::description() const { return parts_->description; }
bool Device::isFile() const { return parts_->device.isFile(); }
bool Device::hasColour() const { return (*parts_)[Sensor::Colour].open(); }
int Device::width_px(Sensor sensor) const { return (*parts_)[sensor].mode.getResolutionX(); }
int Device::height_px(Sensor sensor) const { return (*parts_)[sensor].mode.getResolutionY(); }
int Device::fps(Sensor sensor) const { return (*parts_)[sensor].mode.getFps(); }

Intrinsics Device::intrinsics(Sensor sensor) const {
  const openni::VideoStream& stream = (*parts_)[sensor].stream;
  float horizontal_rad = 0, vertical_rad = 0;
  stream.getProperty(openni::STREAM_PROPERTY_HORIZONTAL_FOV, &horizontal_rad);
  stream.getProperty(openni::STREAM_PROPERTY_VERTICAL_FOV, &vertical_rad);
  return intrinsicsFromFov(horizontal_rad, vertical_rad, width_px(sensor), height_px(sensor));
}

Status Device::setStreaming(bool depth, bool colour) {
  parts_->last_frame = std::chrono::steady_clock::now();
  const Status status = setRunning((*parts_)[Sensor::Depth], depth, parts_->description.uri);
  return status.ok() ? setRunning((*parts_)[Sensor::Colour], colour, parts_->description.uri) : status;
}

Device::Event Device::wait(int timeout_ms, CaptureFrame& frame) {
  if (parts_->disconnected) return Event::Disconnected;
  SensorStream* sensor = waitForStream(*parts_, timeout_ms);
  if (parts_->disconnected) return Event::Disconnected;
  if (!sensor) return parts_->ended || (isFile() && fileEnded(*parts_)) ? Event::End : Event::Nothing;
  if (sensor->stream.readFrame(&parts_->frame) != openni::STATUS_OK) return Event::Nothing;
  parts_->last_frame = std::chrono::steady_clock::now();
  if (isFile() && !parts_->repeat && noteEnd(*sensor, parts_->frame.getFrameIndex())) return Event::Nothing;
  if (!sizeIsRight(parts_->frame, sensor->mode)) return Event::BadFrame;
  frame = borrow(parts_->frame, kSensors[sensor - parts_->sensors.data()], *sensor);
  return Event::Frame;
}

}  // namespace voxid
