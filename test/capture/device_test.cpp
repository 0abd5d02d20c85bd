// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/capture/device.h"

#include "fixtures.h"

namespace voxid {
namespace {

using Event = Device::Event;

class DeviceTest : public ReplayTest {
 protected:
  std::unique_ptr<Device> open(const DeviceOptions& options = {}) {
    auto device = Device::open(options);
    EXPECT_TRUE(device.ok()) << device.status.sentence;
    return std::move(device.value);
  }
  std::unique_ptr<Device> start(const DeviceOptions& options = {}) {
    auto device = open(options);
    EXPECT_TRUE(device && device->setStreaming(true, options.colour).ok());
    return device;
  }
  Status refusal(const std::string& choice) { return Device::open({choice}).status; }
};

TEST_F(DeviceTest, GivesTheBytesOfThePngs) {
  playFrames(4);
  auto device = start();
  ASSERT_TRUE(device);
  CaptureFrame frame;
  for (int i = 0; i < 6; ++i) {  // once round and on
    ASSERT_EQ(nextFrame(*device, frame), Event::Frame);
    ASSERT_EQ(frame.width_px, 160);
    ASSERT_EQ(frame.height_px, 120);
    EXPECT_TRUE(same(pixelsOf(frame), depthImage((frame.index - 1) % 4))) << frame.index;
  }
}

TEST_F(DeviceTest, KeepsTheFrameRate) {
  playFrames(3);
  set("VOXID_REPLAY_FPS", "20");
  auto device = start();
  ASSERT_TRUE(device);
  EXPECT_EQ(device->fps(Sensor::Depth), 20);
  CaptureFrame frame;
  ASSERT_EQ(nextFrame(*device, frame), Event::Frame);
  const auto first_us = frame.timestamp_us;
  const int first = frame.index;
  const auto begin = std::chrono::steady_clock::now();
  while (frame.index < first + 10) ASSERT_EQ(nextFrame(*device, frame), Event::Frame);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  EXPECT_GT(seconds, 0.4);
  EXPECT_LT(seconds, 1.5);
  EXPECT_EQ(frame.timestamp_us - first_us, 50000u * static_cast<unsigned>(frame.index - first));
}

TEST_F(DeviceTest, TellsTheCameraFromTheYamlBesideTheImages) {
  playFrames(1);
  std::ofstream(folder / "camera_info.yaml")
      << "image_width: 160\nimage_height: 120\n"
         "camera_matrix: {rows: 3, cols: 3, data: [131.25, 0, 79.5, 0, 140.5, 59.5, 0, 0, 1]}\n";
  auto device = open();
  ASSERT_TRUE(device);
  const Intrinsics in = device->intrinsics(Sensor::Depth);
  EXPECT_EQ(in.fx_px, 131.25);
  EXPECT_EQ(in.fy_px, 140.5);
  EXPECT_EQ(in.cx_px, 79.5);
  EXPECT_EQ(in.cy_px, 59.5);
}

TEST_F(DeviceTest, GivesColourThatWasTakenWithDepth) {
  playFrames(5, true);
  auto device = start({"", true});
  ASSERT_TRUE(device);
  ASSERT_TRUE(device->hasColour());
  CaptureFrame frame;
  do ASSERT_EQ(nextFrame(*device, frame), Event::Frame);
  while (frame.sensor != Sensor::Colour);
  const cv::Mat rgb = pixelsOf(frame);
  EXPECT_EQ(rgb.at<cv::Vec3b>(60, 80), cv::Vec3b(200, 100, static_cast<std::uint8_t>(10 + (frame.index - 1) % 5)));
}

TEST_F(DeviceTest, PlaysOnceWithoutLoop) {
  playFrames(3);
  set("VOXID_REPLAY_LOOP", "0");
  auto device = start();
  ASSERT_TRUE(device);
  CaptureFrame frame;
  Event event;
  while ((event = nextFrame(*device, frame)) == Event::Frame) EXPECT_LE(frame.index, 3);
  EXPECT_EQ(event, Event::End);
}

TEST_F(DeviceTest, ChoosesByNumberSerialAndUri) {
  TempFolder other;
  writeFrames(folder.path(), 1);
  cv::imwrite(other / "only_depth.png", depthImage(0, 80, 60));
  play(folder.path() + ":" + other.path());
  const auto devices = listDevices();
  ASSERT_EQ(devices.value.size(), 2u);
  const DeviceDescription& second = devices.value[1];
  EXPECT_EQ(second.serial, "replay-" + std::filesystem::path(other.path()).filename().string());
  for (const std::string& choice : {std::string("#2"), second.serial, second.uri}) {
    auto device = open({choice});
    ASSERT_TRUE(device) << choice;
    EXPECT_EQ(device->width_px(Sensor::Depth), 80) << choice;
    EXPECT_EQ(device->description().serial, second.serial);
  }
  EXPECT_EQ(open()->width_px(Sensor::Depth), 160);
}

TEST_F(DeviceTest, OpensAFolderByUriWithoutEnvironment) {
  writeFrames(folder.path(), 2);
  auto device = start({"replay:" + folder.path() + "?fps=60&serial=mine"});
  ASSERT_TRUE(device);
  EXPECT_EQ(device->fps(Sensor::Depth), 60);
  EXPECT_EQ(device->description().serial, "mine");
  CaptureFrame frame;
  EXPECT_EQ(nextFrame(*device, frame), Event::Frame);
}

TEST_F(DeviceTest, ReadsFoldersOfOtherLayouts) {
  std::filesystem::create_directories(folder / "depth");
  std::filesystem::create_directories(folder / "rgb");
  cv::imwrite(folder / "depth/0001.png", depthImage(7));
  cv::imwrite(folder / "rgb/0001.png", cv::Mat(120, 160, CV_8UC3, cv::Scalar(1, 2, 3)));
  auto device = start({"replay:" + folder.path(), true});
  ASSERT_TRUE(device);
  EXPECT_TRUE(device->hasColour());
  TempFolder plain;
  cv::imwrite(plain / "a.png", depthImage(3));
  device = start({"replay:" + plain.path()});
  CaptureFrame frame;
  ASSERT_EQ(nextFrame(*device, frame), Event::Frame);
  EXPECT_TRUE(same(pixelsOf(frame), depthImage(3)));
}

TEST_F(DeviceTest, ConvertsTenthsOfMillimetres) {
  playFrames(1);
  set("VOXID_REPLAY_UNIT", "100um");
  auto device = start();
  ASSERT_TRUE(device);
  CaptureFrame frame;
  ASSERT_EQ(nextFrame(*device, frame), Event::Frame);
  EXPECT_TRUE(frame.tenth_mm);
  EXPECT_TRUE(same(pixelsOf(frame), depthImage(0)));
}

TEST_F(DeviceTest, RefusesModesThatHoldNoDepth) {
  playFrames(1);
  set("VOXID_REPLAY_UNIT", "shift");
  const Status status = refusal("");
  EXPECT_EQ(status.kind, Status::Kind::CannotDo);
  EXPECT_NE(status.sentence.find("offers no depth mode that can be read"), std::string::npos) << status.sentence;
}

TEST_F(DeviceTest, PutsAMirroredDeviceRight) {
  playFrames(1);
  set("VOXID_REPLAY_MIRROR", "1");
  auto device = start();
  ASSERT_TRUE(device);
  CaptureFrame frame;
  ASSERT_EQ(nextFrame(*device, frame), Event::Frame);
  EXPECT_TRUE(frame.mirrored);
  EXPECT_TRUE(same(pixelsOf(frame), depthImage(0)));
}

TEST_F(DeviceTest, NoticesThatItWasUnpluggedAndOpensAgain) {
  playFrames(2);
  useControl();
  auto device = start();
  ASSERT_TRUE(device);
  CaptureFrame frame;
  ASSERT_EQ(nextFrame(*device, frame), Event::Frame);
  command("unplug");
  Event event;
  while ((event = nextFrame(*device, frame)) == Event::Frame) continue;
  EXPECT_EQ(event, Event::Disconnected);
  EXPECT_EQ(refusal("").kind, Status::Kind::CannotDo);
  command("replug");
  ASSERT_TRUE(eventually([] { return listDevices().value.size() == 1; }));
  device = start();  // the first one is still there until now
  ASSERT_TRUE(device);
  EXPECT_EQ(nextFrame(*device, frame), Event::Frame);
}

TEST_F(DeviceTest, ThrowsShortFramesAway) {
  playFrames(2);
  useControl();
  auto device = start();
  ASSERT_TRUE(device);
  command("corrupt 2");
  CaptureFrame frame;
  int bad = 0;
  for (int i = 0; i < 60 && bad < 2; ++i) bad += nextFrame(*device, frame) == Event::BadFrame;
  EXPECT_EQ(bad, 2);
  EXPECT_EQ(nextFrame(*device, frame), Event::Frame);
}

TEST_F(DeviceTest, ShowsDroppedFramesByTheirIndex) {
  playFrames(2);
  useControl();
  auto device = start();
  ASSERT_TRUE(device);
  CaptureFrame frame;
  ASSERT_EQ(nextFrame(*device, frame), Event::Frame);
  command("drop 5");
  int last = frame.index, widest = 0;
  for (int i = 0; i < 60 && widest < 6; ++i) {
    ASSERT_EQ(nextFrame(*device, frame), Event::Frame);
    widest = std::max(widest, frame.index - last);
    last = frame.index;
  }
  EXPECT_GE(widest, 6);
}

TEST_F(DeviceTest, RefusesFoldersWithoutDepth) {
  cv::imwrite(folder / "picture_depth.png", cv::Mat(4, 4, CV_8UC3, cv::Scalar(0)));
  const Status status = refusal("replay:" + folder.path());
  EXPECT_EQ(status.kind, Status::Kind::CannotDo);
  EXPECT_NE(status.sentence.find("is not a depth image"), std::string::npos) << status.sentence;
  TempFolder empty;
  EXPECT_NE(refusal("replay:" + empty.path()).sentence.find("holds no depth images"), std::string::npos);
}

TEST_F(DeviceTest, SaysWhatWasLookedForWithoutADevice) {
  EXPECT_EQ(refusal("").sentence, "no device: OpenNI2 sees no device; check the cable and the udev rules");
  EXPECT_NE(refusal("XYZ-1").sentence.find("'XYZ-1'"), std::string::npos);
  EXPECT_EQ(refusal("#1").kind, Status::Kind::CannotDo);
  EXPECT_EQ(refusal("#one").kind, Status::Kind::BadUse);
}

}  // namespace
}  // namespace voxid
