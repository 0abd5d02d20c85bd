// SPDX-License-Identifier: BSD-3-Clause
#include "stream.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <opencv2/core.hpp>

namespace voxid::replay {
namespace {

OniPixelFormat pixelFormat(OniSensorType sensor, DepthCoding coding) {
  if (sensor == ONI_SENSOR_COLOR) return ONI_PIXEL_FORMAT_RGB888;
  if (coding == DepthCoding::TenthMm) return ONI_PIXEL_FORMAT_DEPTH_100_UM;
  return coding == DepthCoding::Shift ? ONI_PIXEL_FORMAT_SHIFT_9_2 : ONI_PIXEL_FORMAT_DEPTH_1_MM;
}

cv::Mat inTenthMm(const cv::Mat& depth_mm) {
  cv::Mat out(depth_mm.size(), CV_16UC1);
  std::transform(depth_mm.begin<std::uint16_t>(), depth_mm.end<std::uint16_t>(), out.begin<std::uint16_t>(),
                 [](std::uint16_t mm) { return static_cast<std::uint16_t>(mm > 6553 ? 0 : mm * 10); });
  return out;
}

cv::Mat noiseLike(const cv::Mat& image, int seed) {
  cv::Mat out(image.size(), image.type());
  cv::RNG generator(static_cast<std::uint64_t>(seed));  // the same on every run
  generator.fill(out, cv::RNG::UNIFORM, 0, 65536);
  return out;
}

template <typename T>
OniStatus answer(const T& value, void* data, int* bytes) {
  if (*bytes < static_cast<int>(sizeof value)) return ONI_STATUS_BAD_PARAMETER;
  std::memcpy(data, &value, sizeof value);
  *bytes = sizeof value;
  return ONI_STATUS_OK;
}

}  // namespace

OniVideoMode videoMode(OniSensorType sensor, const Config& config, const FrameFolder& frames) {
  const cv::Mat& first = sensor == ONI_SENSOR_COLOR ? frames.colour(0) : frames.depth(0);
  return {pixelFormat(sensor, config.coding), first.cols, first.rows, config.fps};
}

ReplayStream::ReplayStream(OniSensorType sensor, const Config& config, const FrameFolder& frames, Player& player)
    : sensor_(sensor), config_(config), frames_(frames), player_(player), mode_(videoMode(sensor, config, frames)) {}

OniStatus ReplayStream::start() {
  player_.add(this);
  return ONI_STATUS_OK;
}

void ReplayStream::stop() { player_.remove(this); }

float ReplayStream::fov_rad(int length_px, double focal_px) const {
  return static_cast<float>(2 * std::atan(length_px / (2 * focal_px)));
}

OniStatus ReplayStream::getProperty(int property, void* data, int* bytes) {
  const double scale = static_cast<double>(mode_.resolutionX) / frames_.width_px();
  switch (property) {
    case ONI_STREAM_PROPERTY_VIDEO_MODE:
      return answer(mode_, data, bytes);
    case ONI_STREAM_PROPERTY_CROPPING:  // without an answer here a recording plays nothing back
      return answer(OniCropping{FALSE, 0, 0, mode_.resolutionX, mode_.resolutionY}, data, bytes);
    case ONI_STREAM_PROPERTY_HORIZONTAL_FOV:
      return answer(fov_rad(mode_.resolutionX, frames_.fx_px() * scale), data, bytes);
    case ONI_STREAM_PROPERTY_VERTICAL_FOV:
      return answer(fov_rad(mode_.resolutionY, frames_.fy_px() * scale), data, bytes);
    case ONI_STREAM_PROPERTY_MAX_VALUE:
      return answer(sensor_ == ONI_SENSOR_DEPTH ? 65535 : 255, data, bytes);
    case ONI_STREAM_PROPERTY_MIN_VALUE:
      return answer(0, data, bytes);
    case ONI_STREAM_PROPERTY_MIRRORING:
      return answer<OniBool>(config_.mirror ? TRUE : FALSE, data, bytes);
    case ONI_STREAM_PROPERTY_NUMBER_OF_FRAMES:
      return answer(frames_.size() * config_.hold, data, bytes);
    default:
      return ONI_STATUS_NOT_SUPPORTED;
  }
}

OniStatus ReplayStream::setProperty(int property, const void* data, int bytes) {
  if (property == ONI_STREAM_PROPERTY_VIDEO_MODE && bytes == static_cast<int>(sizeof mode_))
    return std::memcmp(data, &mode_, sizeof mode_) == 0 ? ONI_STATUS_OK : ONI_STATUS_NOT_SUPPORTED;
  if (property == ONI_STREAM_PROPERTY_MIRRORING && bytes == static_cast<int>(sizeof(OniBool)))
    return *static_cast<const OniBool*>(data) == (config_.mirror ? TRUE : FALSE) ? ONI_STATUS_OK
                                                                                 : ONI_STATUS_NOT_SUPPORTED;
  return ONI_STATUS_NOT_SUPPORTED;
}

OniBool ReplayStream::isPropertySupported(int property) {
  return property == ONI_STREAM_PROPERTY_CROPPING ||
         (property >= ONI_STREAM_PROPERTY_HORIZONTAL_FOV && property <= ONI_STREAM_PROPERTY_MIN_VALUE) ||
         property == ONI_STREAM_PROPERTY_MIRRORING || property == ONI_STREAM_PROPERTY_NUMBER_OF_FRAMES;
}

cv::Mat ReplayStream::pixelsOf(const Shot& shot) const {
  cv::Mat image = sensor_ == ONI_SENSOR_COLOR ? frames_.colour(shot.image) : frames_.depth(shot.image);
  if (sensor_ == ONI_SENSOR_DEPTH && config_.coding == DepthCoding::TenthMm) image = inTenthMm(image);
  if (shot.effect == Faults::Effect::Noise) image = noiseLike(image, shot.index);
  if (!config_.mirror) return image;
  cv::Mat mirrored;
  cv::flip(image, mirrored, 1);
  return mirrored;
}

void ReplayStream::describe(const Shot& shot, OniFrame& frame) const {
  frame.sensorType = sensor_;
  frame.timestamp = shot.timestamp_us;
  frame.frameIndex = shot.index;
  frame.width = mode_.resolutionX;
  frame.height = mode_.resolutionY;
  frame.videoMode = mode_;
  frame.croppingEnabled = FALSE;
  frame.cropOriginX = frame.cropOriginY = 0;
}

void ReplayStream::show(const Shot& shot) {
  OniFrame* frame = getServices().acquireFrame();
  if (!frame) return;
  const cv::Mat pixels = pixelsOf(shot);
  const std::size_t bytes = pixels.total() * pixels.elemSize();
  describe(shot, *frame);
  frame->stride = static_cast<int>(pixels.cols * pixels.elemSize());
  frame->dataSize =
      static_cast<int>(shot.effect == Faults::Effect::Corrupt ? bytes / 2 : bytes);  // as a lost USB packet leaves it
  std::memcpy(frame->data, pixels.data, static_cast<std::size_t>(frame->dataSize));
  raiseNewFrame(frame);
  getServices().releaseFrame(frame);
}

}  // namespace voxid::replay
