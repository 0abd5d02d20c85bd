// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "capture/parts.h"

namespace voxid {
namespace {

const std::vector<DeviceDescription> kTwo = {{"usb/1", "v", "Xtion", "A1"}, {"usb/2", "v", "Carmine", "B2"}};

openni::VideoMode mode(openni::PixelFormat format, int width, int height, int fps) {
  openni::VideoMode m;
  m.setPixelFormat(format);
  m.setResolution(width, height);
  m.setFps(fps);
  return m;
}

const openni::VideoMode* choose(Sensor sensor, std::vector<openni::VideoMode>& modes) {
  static openni::Array<openni::VideoMode> array;
  array._setData(modes.data(), static_cast<int>(modes.size()));
  return chooseMode(sensor, array);
}

TEST(ChooseDevice, TakesTheFirstByDefault) { EXPECT_EQ(chooseDevice("", kTwo).value.uri, "usb/1"); }
TEST(ChooseDevice, CountsFromOne) { EXPECT_EQ(chooseDevice("#2", kTwo).value.uri, "usb/2"); }
TEST(ChooseDevice, KnowsSerialNumbers) { EXPECT_EQ(chooseDevice("B2", kTwo).value.uri, "usb/2"); }
TEST(ChooseDevice, KnowsUris) { EXPECT_EQ(chooseDevice("usb/2", kTwo).value.serial, "B2"); }

TEST(ChooseDevice, SaysWhatIsThereIfNothingFits) {
  const auto result = chooseDevice("#3", kTwo);
  EXPECT_EQ(result.status.kind, Status::Kind::CannotDo);
  EXPECT_EQ(result.status.sentence, "no device #3: OpenNI2 sees #1 Xtion usb/1 serial A1, #2 Carmine usb/2 serial B2");
}

TEST(ChooseDevice, SaysThatNothingIsThere) {
  EXPECT_EQ(chooseDevice("", {}).status.kind, Status::Kind::CannotDo);
  EXPECT_NE(chooseDevice("", {}).status.sentence.find("OpenNI2 sees no device"), std::string::npos);
}

TEST(ChooseDevice, RefusesNumbersThatAreNone) {
  for (const char* bad : {"#", "#0", "#-1", "#x", "#1x"})
    EXPECT_EQ(chooseDevice(bad, kTwo).status.kind, Status::Kind::BadUse) << bad;
}

TEST(ChooseMode, PrefersMillimetresThenVgaThenThirty) {
  std::vector<openni::VideoMode> modes = {
      mode(openni::PIXEL_FORMAT_DEPTH_100_UM, 640, 480, 30), mode(openni::PIXEL_FORMAT_DEPTH_1_MM, 320, 240, 30),
      mode(openni::PIXEL_FORMAT_DEPTH_1_MM, 640, 480, 25), mode(openni::PIXEL_FORMAT_DEPTH_1_MM, 640, 480, 30)};
  EXPECT_EQ(choose(Sensor::Depth, modes), &modes[3]);
  modes.pop_back();
  EXPECT_EQ(choose(Sensor::Depth, modes), &modes[2]);
  modes.pop_back();
  EXPECT_EQ(choose(Sensor::Depth, modes), &modes[1]);
  modes.pop_back();
  EXPECT_EQ(choose(Sensor::Depth, modes), &modes[0]);
}

TEST(ChooseMode, RefusesWhatIsNoDepth) {
  std::vector<openni::VideoMode> modes = {mode(openni::PIXEL_FORMAT_SHIFT_9_2, 640, 480, 30),
                                          mode(openni::PIXEL_FORMAT_SHIFT_9_3, 640, 480, 30)};
  EXPECT_EQ(choose(Sensor::Depth, modes), nullptr);
}

TEST(ChooseMode, ReadsColourAsRgbOnly) {
  std::vector<openni::VideoMode> modes = {mode(openni::PIXEL_FORMAT_YUV422, 640, 480, 30),
                                          mode(openni::PIXEL_FORMAT_RGB888, 320, 240, 30)};
  EXPECT_EQ(choose(Sensor::Colour, modes), &modes[1]);
}

TEST(IntrinsicsFromFov, GivesBackTheFocalLengthThatAFloatHolds) {
  const auto fov = [](int length, double f) { return static_cast<float>(2 * std::atan(length / (2 * f))); };
  const Intrinsics in = intrinsicsFromFov(fov(640, 525), fov(480, 570.3), 640, 480);
  EXPECT_EQ(in.fx_px, 525.0);
  EXPECT_EQ(in.fy_px, 570.3);
  EXPECT_EQ(in.cx_px, 319.5);
  EXPECT_EQ(in.cy_px, 239.5);
}

TEST(IntrinsicsFromFov, TakesSquarePixelsWithoutVerticalField) {
  EXPECT_EQ(intrinsicsFromFov(1.0, 0, 640, 480).fy_px, intrinsicsFromFov(1.0, 0, 640, 480).fx_px);
}

TEST(CaptureFrame, ConvertsTenthsOfMillimetresRoundingToNearest) {
  const std::uint16_t pixels[] = {0, 10000, 10004, 10005, 65535};
  CaptureFrame frame;
  frame.data = pixels;
  frame.width_px = 5;
  frame.height_px = 1;
  frame.row_bytes = sizeof pixels;
  frame.tenth_mm = true;
  std::uint16_t out[5];
  frame.copyTo(out, sizeof out);
  const std::uint16_t expected[] = {0, 1000, 1000, 1001, 6554};
  EXPECT_EQ(std::memcmp(out, expected, sizeof out), 0);
}

TEST(CaptureFrame, PutsMirroredColourRight) {
  const std::uint8_t pixels[] = {1, 2, 3, 4, 5, 6, 0, 0, 7, 8, 9, 10, 11, 12, 0, 0};  // two pixels a row, padded
  CaptureFrame frame;
  frame.sensor = Sensor::Colour;
  frame.data = pixels;
  frame.width_px = 2;
  frame.height_px = 2;
  frame.row_bytes = 8;
  frame.mirrored = true;
  std::uint8_t out[12];
  frame.copyTo(out, 6);
  const std::uint8_t expected[] = {4, 5, 6, 1, 2, 3, 10, 11, 12, 7, 8, 9};
  EXPECT_EQ(std::memcmp(out, expected, sizeof out), 0);
}

}  // namespace
}  // namespace voxid
