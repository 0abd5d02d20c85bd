// SPDX-License-Identifier: BSD-3-Clause
// A device recorded to a real .oni file and played back by OpenNI2's own driver.
#include "voxid/capture/record.h"

#include <Eigen/Core>

#include "fixtures.h"
#include "voxid/capture/capture_loop.h"
#include "voxid/geometry/segmenter.h"

namespace voxid {
namespace {

using Event = Device::Event;
constexpr char kScenes[] = "../shared/data/scenes/mosd";

class RecordTest : public ReplayTest {
 protected:
  Status recordTo(const std::string& path, const RecordLimits& limits, bool colour = false) {
    auto device = Device::open({"", colour});
    if (!device.ok()) return device.status;
    return record(*device.value, path, limits, report_);
  }
  /// Every depth frame of a device until it ends.
  std::vector<cv::Mat> readAll(Device& device) {
    EXPECT_TRUE(device.setStreaming(true, device.hasColour()).ok());
    std::vector<cv::Mat> frames;
    CaptureFrame frame;
    for (Event event; (event = nextFrame(device, frame)) == Event::Frame;)
      if (frame.sensor == Sensor::Depth) frames.push_back(pixelsOf(frame));
    return frames;
  }
  std::vector<cv::Mat> readFile(const std::string& path, bool colour = false) {
    auto device = Device::open({path, colour});
    EXPECT_TRUE(device.ok()) << device.status.sentence;
    return device.ok() ? readAll(*device.value) : std::vector<cv::Mat>{};
  }

  TempFolder out;
  RecordReport report_;
};

std::vector<std::string> namesIn(const TempFolder& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
    names.push_back(entry.path().filename().string());
  return names;
}

TEST_F(RecordTest, PlaysBackWhatWasRecordedByteForByte) {
  playFrames(12);
  RecordLimits limits;
  limits.frames = 10;
  ASSERT_TRUE(recordTo(out / "x.oni", limits).ok());
  EXPECT_GE(report_.frames, 10);
  EXPECT_EQ(namesIn(out), std::vector<std::string>{"x.oni"});
  for (int round = 0; round < 3; ++round) {
    const std::vector<cv::Mat> frames = readFile(out / "x.oni");
    ASSERT_EQ(static_cast<int>(frames.size()), report_.frames);
    for (int i = 0; i < report_.frames; ++i)
      EXPECT_TRUE(same(frames[static_cast<std::size_t>(i)], depthImage(i % 12))) << i;
  }
}

TEST_F(RecordTest, KeepsTheCamera) {
  playFrames(2);
  std::ofstream(folder / "camera_info.yaml")
      << "camera_matrix: {rows: 3, cols: 3, data: [131.25, 0, 79.5, 0, 131.25, 59.5, 0, 0, 1]}\n";
  RecordLimits limits;
  limits.frames = 2;
  ASSERT_TRUE(recordTo(out / "x.oni", limits).ok());
  const auto device = Device::open({out / "x.oni"});
  ASSERT_TRUE(device.ok());
  EXPECT_TRUE(device.value->isFile());
  EXPECT_EQ(device.value->intrinsics(Sensor::Depth).fx_px, 131.25);
}

TEST_F(RecordTest, RecordsColourToo) {
  playFrames(4, true);
  RecordLimits limits;
  limits.frames = 4;
  ASSERT_TRUE(recordTo(out / "x.oni", limits, true).ok());
  auto device = Device::open({out / "x.oni", true});
  ASSERT_TRUE(device.ok());
  ASSERT_TRUE(device.value->hasColour());
  ASSERT_TRUE(device.value->setStreaming(true, true).ok());
  CaptureFrame frame;
  int colours = 0;
  while (nextFrame(*device.value, frame) == Event::Frame)
    if (frame.sensor == Sensor::Colour) {
      ++colours;
      EXPECT_EQ(pixelsOf(frame).at<cv::Vec3b>(60, 80),
                cv::Vec3b(200, 100, static_cast<std::uint8_t>(10 + (frame.index - 1) % 4)));
    }
  EXPECT_GE(colours, 3);
}

TEST_F(RecordTest, PutsAMirroredRecordingRight) {
  playFrames(2);
  set("VOXID_REPLAY_MIRROR", "1");
  RecordLimits limits;
  limits.frames = 2;
  ASSERT_TRUE(recordTo(out / "x.oni", limits).ok());
  const std::vector<cv::Mat> frames = readFile(out / "x.oni");
  ASSERT_GE(frames.size(), 2u);
  EXPECT_TRUE(same(frames[0], depthImage(0)));
}

TEST_F(RecordTest, LeavesAnOlderFileIfNothingComes) {
  playFrames(2);
  useControl();
  std::ofstream(out / "x.oni") << "older";
  auto device = Device::open({});
  ASSERT_TRUE(device.ok());
  command("stall 60000");
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  RecordLimits limits;
  limits.silence_ms = 300;
  EXPECT_EQ(record(*device.value, out / "x.oni", limits, report_).kind, Status::Kind::CannotDo);
  EXPECT_EQ(namesIn(out), std::vector<std::string>{"x.oni"});
  EXPECT_EQ(std::filesystem::file_size(out / "x.oni"), 5u);
}

TEST_F(RecordTest, KeepsWhatCameBeforeADisconnect) {
  playFrames(4);
  useControl();
  std::thread unplugger([this] {
    std::this_thread::sleep_for(std::chrono::milliseconds(800));
    command("unplug");
  });
  const Status status = recordTo(out / "x.oni", {});
  unplugger.join();
  EXPECT_EQ(status.kind, Status::Kind::CannotDo);
  EXPECT_NE(status.sentence.find("vanished after"), std::string::npos) << status.sentence;
  EXPECT_FALSE(readFile(out / "x.oni").empty());
}

TEST_F(RecordTest, RefusesAFolderThatIsNotThere) {
  playFrames(1);
  RecordLimits limits;
  limits.frames = 1;
  EXPECT_EQ(recordTo(out / "no/x.oni", limits).kind, Status::Kind::CannotDo);
}

TEST_F(RecordTest, RefusesDamagedRecordingsWithOneSentence) {
  playFrames(3);
  RecordLimits limits;
  limits.frames = 3;
  ASSERT_TRUE(recordTo(out / "x.oni", limits).ok());
  const auto whole = std::filesystem::file_size(out / "x.oni");
  for (const auto bytes : {std::uintmax_t{100}, whole / 4, whole / 2, whole - 30, whole - 28, whole - 1}) {
    std::filesystem::copy_file(out / "x.oni", out / "cut.oni", std::filesystem::copy_options::overwrite_existing);
    std::filesystem::resize_file(out / "cut.oni", bytes);
    const Status status = Device::open({out / "cut.oni"}).status;
    EXPECT_EQ(status.kind, Status::Kind::Damaged) << bytes << " of " << whole;
    EXPECT_NE(status.sentence.find("is cut short"), std::string::npos) << status.sentence;
  }
  std::ofstream(out / "empty.oni");
  EXPECT_EQ(Device::open({out / "empty.oni"}).status.kind, Status::Kind::Damaged);
  std::ofstream(out / "text.oni") << "this is a text and no recording, long enough to hold a header of such a file";
  EXPECT_EQ(Device::open({out / "text.oni"}).status.kind, Status::Kind::Damaged);
  EXPECT_EQ(Device::open({out / "missing.oni"}).status.kind, Status::Kind::CannotDo);
}

TEST_F(RecordTest, LoopPlaysARecordingOnceOrForEver) {
  playFrames(4);
  RecordLimits limits;
  limits.frames = 4;
  ASSERT_TRUE(recordTo(out / "x.oni", limits).ok());
  std::atomic<int> frames{0};
  CaptureLoop::Sink sink;
  sink.frame = [&](const CaptureFrame&, const Intrinsics&) { ++frames; };
  {
    CaptureLoop loop({out / "x.oni", false, false}, sink);
    loop.demand(true, false);
    ASSERT_TRUE(eventually([&] { return loop.snapshot().state == CaptureState::Ended; }));
    EXPECT_EQ(frames, report_.frames);
  }
  CaptureLoop loop({out / "x.oni", false, true}, sink);
  loop.demand(true, false);
  EXPECT_TRUE(eventually([&] { return frames > 4 * report_.frames; }));
  EXPECT_EQ(loop.snapshot().state, CaptureState::Running);
}

/// What a scene says, comparable.
std::vector<float> summaryOf(const Scene& scene) {
  std::vector<float> out = {static_cast<float>(scene.status), scene.table.distance_m,
                            static_cast<float>(scene.table.inliers)};
  for (const Cluster& c : scene.clusters)
    out.insert(out.end(), {static_cast<float>(c.pixels.size), c.centroid_m.x(), c.centroid_m.y(), c.centroid_m.z(),
                           c.extents_m.x(), c.extents_m.y(), c.extents_m.z()});
  return out;
}

DepthView viewOf(const cv::Mat& image, const Intrinsics& in) {
  return {image.data,
          image.cols,
          image.rows,
          image.step,
          DepthUnit::MillimetreU16,
          Camera::fromPixels(in.fx_px, in.fy_px, in.cx_px, in.cy_px)};
}

TEST_F(RecordTest, FindsTheSameObjectsInTheSamePlacesInARecording) {
  if (!std::filesystem::exists(kScenes)) GTEST_SKIP() << "no real scenes: " << kScenes << " is absent";
  const char* scenes[] = {"learn0", "learn10", "test0"};
  for (const char* scene : scenes)
    std::filesystem::copy(std::string(kScenes) + "/" + scene + "_depth.png",
                          folder / (std::string(scene) + "_depth.png"));
  std::filesystem::copy(std::string(kScenes) + "/camera_info.yaml", folder / "camera_info.yaml");
  play(folder.path());
  RecordLimits limits;
  limits.frames = 3;
  ASSERT_TRUE(recordTo(out / "x.oni", limits).ok());
  auto file = Device::open({out / "x.oni"});
  ASSERT_TRUE(file.ok());
  const Intrinsics in = file.value->intrinsics(Sensor::Depth);
  EXPECT_EQ(in.fx_px, 525.0);
  const std::vector<cv::Mat> played = readAll(*file.value);
  ASSERT_GE(played.size(), 3u);
  Segmenter segmenter;
  for (std::size_t i = 0; i < 3; ++i) {
    const cv::Mat png = cv::imread(folder / (std::string(scenes[i]) + "_depth.png"), cv::IMREAD_UNCHANGED);
    ASSERT_TRUE(same(played[i], png)) << scenes[i];
    const auto direct = summaryOf(segmenter.segment(viewOf(png, {525, 525, 319.5, 239.5}), {}));
    const auto again = summaryOf(segmenter.segment(viewOf(played[i], in), {}));
    EXPECT_GT(direct.size(), 3u) << "no object in " << scenes[i];
    EXPECT_EQ(direct, again) << scenes[i];
  }
}

}  // namespace
}  // namespace voxid
