// SPDX-License-Identifier: BSD-3-Clause
// Folders of depth images and the environment in which the replay driver plays them.
#pragma once

#include <gtest/gtest.h>
#include <stdlib.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <thread>
#include <vector>

#include "voxid/capture/device.h"

namespace voxid {

class TempFolder {
 public:
  TempFolder() {
    std::string text = (std::filesystem::temp_directory_path() / "voxid-capture-XXXXXX").string();
    path_ = mkdtemp(text.data());
  }
  ~TempFolder() { std::filesystem::remove_all(path_); }
  std::string operator/(const std::string& name) const { return (path_ / name).string(); }
  std::string path() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

/// Every frame and every pixel differs; some pixels have no depth.
inline cv::Mat depthImage(int frame, int width = 160, int height = 120) {
  cv::Mat image(height, width, CV_16UC1);
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u)
      image.at<std::uint16_t>(v, u) =
          static_cast<std::uint16_t>((u + v) % 17 == 0 ? 0 : 500 + 7 * u + 3 * v + 11 * frame);
  return image;
}

/// `frames` depth images f00_depth.png, ... (and colour images beside them).
inline void writeFrames(const std::string& folder, int frames, bool colour = false) {
  for (int i = 0; i < frames; ++i) {
    const std::string stem = folder + "/f" + (i < 10 ? "0" : "") + std::to_string(i);
    cv::imwrite(stem + "_depth.png", depthImage(i));
    if (colour)
      cv::imwrite(stem + "_color.png", cv::Mat(120, 160, CV_8UC3, cv::Scalar(10 + i, 100, 200)));  // blue, green, red
  }
}

inline cv::Mat pixelsOf(const CaptureFrame& frame) {
  cv::Mat out(frame.height_px, frame.width_px, frame.sensor == Sensor::Depth ? CV_16UC1 : CV_8UC3);
  frame.copyTo(out.data, out.step);
  return out;
}

inline bool same(const cv::Mat& a, const cv::Mat& b) {
  return a.type() == b.type() && a.size() == b.size() && std::equal(a.datastart, a.dataend, b.datastart);
}

/// A replayed folder in the environment, from before OpenNI2 starts until the test's end.
class ReplayTest : public ::testing::Test {
 protected:
  void TearDown() override {
    for (const std::string& name : set_) unsetenv(name.c_str());
  }
  void set(const std::string& name, const std::string& value) {
    setenv(name.c_str(), value.c_str(), 1);
    set_.push_back(name);
  }
  void play(const std::string& path) { set("VOXID_REPLAY", path); }
  void playFrames(int frames, bool colour = false) {
    writeFrames(folder.path(), frames, colour);
    play(folder.path());
  }
  void useControl() { set("VOXID_REPLAY_CONTROL", folder / "control"); }
  void command(const std::string& line) { std::ofstream(folder / "control", std::ios::app) << line << std::endl; }

  TempFolder folder;

 private:
  std::vector<std::string> set_;
};

/// Waits for what must come; a second is a long time for a folder played at 30/s, ten are for a busy machine.
inline bool eventually(const std::function<bool()>& condition) {
  for (int i = 0; i < 2000; ++i) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return false;
}

/// The next frame, with a patience that outlasts a busy machine.
inline Device::Event nextFrame(Device& device, CaptureFrame& frame) {
  Device::Event event = Device::Event::Nothing;
  for (int i = 0; i < 50 && event == Device::Event::Nothing; ++i) event = device.wait(200, frame);
  return event;
}

}  // namespace voxid
