// SPDX-License-Identifier: BSD-3-Clause
// The capture nodelet in the test's own process, as in one manager, on folders that the replay driver plays.
#include "capture_nodelet.h"

#include <diagnostic_msgs/DiagnosticArray.h>
#include <dynamic_reconfigure/Reconfigure.h>
#include <nodelet/loader.h>
#include <rosgraph_msgs/Log.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <map>
#include <set>

#include "capture/fixtures.h"
#include "classification_nodelet.h"
#include "listener.h"
#include "segmentation_nodelet.h"

namespace voxid {
namespace {

using test::Listener;
using Image = sensor_msgs::Image;
using CameraInfo = sensor_msgs::CameraInfo;

/// Addresses of pixels, by stamp.
class Addresses {
 public:
  void note(const Image& image) {
    const std::lock_guard<std::mutex> lock(mutex_);
    seen_[image.header.stamp] = image.data.data();
  }
  std::map<ros::Time, const void*> all() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return seen_;
  }

 private:
  std::mutex mutex_;
  std::map<ros::Time, const void*> seen_;
};
Addresses captured, classified;

class SpyCapture : public CaptureNodelet {
  void publish(const Output& output, const sensor_msgs::ImagePtr& image,
               const sensor_msgs::CameraInfoPtr& info) override {
    captured.note(*image);
    CaptureNodelet::publish(output, image, info);
  }
};

class SpyClassification : public ClassificationNodelet {
  void onFrame(const sensor_msgs::ImageConstPtr& image, const sensor_msgs::CameraInfoConstPtr& info,
               const SegmentsConstPtr& segments) override {
    classified.note(*image);
    ClassificationNodelet::onFrame(image, info, segments);
  }
};

boost::shared_ptr<nodelet::Nodelet> create(const std::string& type) {
  if (type == "voxid/segmentation") return boost::make_shared<SegmentationNodelet>();
  if (type == "voxid/classification") return boost::make_shared<SpyClassification>();
  return boost::make_shared<SpyCapture>();
}

/// What a nodelet last said of itself, and what was logged as an error.
class Reports {
 public:
  explicit Reports(const std::string& name) : name_(name) {
    diagnostics_ = node_.subscribe("/diagnostics", 50, &Reports::onDiagnostics, this);
    log_ = node_.subscribe("/rosout", 200, &Reports::onLog, this);
  }
  int level() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return level_;
  }
  std::string value(const std::string& key) {
    const std::lock_guard<std::mutex> lock(mutex_);
    return values_[key];
  }
  std::vector<std::string> errors() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return errors_;
  }

 private:
  void onDiagnostics(const diagnostic_msgs::DiagnosticArrayConstPtr& array) {
    const std::lock_guard<std::mutex> lock(mutex_);
    for (const auto& status : array->status) {
      if (status.name.find(name_) == std::string::npos) continue;
      level_ = status.level;
      for (const auto& pair : status.values) values_[pair.key] = pair.value;
    }
  }
  void onLog(const rosgraph_msgs::LogConstPtr& log) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (log->level >= rosgraph_msgs::Log::ERROR) errors_.push_back(log->msg);
  }

  const std::string name_;
  std::mutex mutex_;
  int level_ = -1;
  std::map<std::string, std::string> values_;
  std::vector<std::string> errors_;
  ros::NodeHandle node_;
  ros::Subscriber diagnostics_, log_;
};

class CaptureNodeletTest : public ReplayTest {
 protected:
  static constexpr int kStall_ms = 2000;  // a busy machine alone may hold a frame back for half a second

  CaptureNodeletTest()
      : name_(std::string("/") + testing::UnitTest::GetInstance()->current_test_info()->name()),
        node_(name_),
        loader_(boost::function<boost::shared_ptr<nodelet::Nodelet>(const std::string&)>(create)),
        reports_(name_.substr(1) + "/capture") {
    node_.setParam("capture/stall_ms", kStall_ms);
    node_.setParam("capture/retry_first_ms", 50);
    node_.setParam("capture/retry_most_ms", 200);
  }
  ~CaptureNodeletTest() override { loader_.clear(); }

  void start(const std::string& nodelet = "capture") {
    ASSERT_TRUE(loader_.load(name_ + "/" + nodelet, "voxid/" + nodelet, {}, {}));
  }

  template <typename M>
  boost::shared_ptr<const M> first(Listener<M>& listener) {
    boost::shared_ptr<const M> message;
    test::eventually(10, [&] { return (message = listener.find([](const ros::Time&) { return true; })) != nullptr; });
    return message;
  }
  template <typename M>
  bool moreCome(Listener<M>& listener) {
    const std::size_t before = listener.count();
    return test::eventually(10, [&] { return listener.count() > before + 2; });
  }
  bool stateBecomes(const std::string& state) {
    return test::eventually(10, [&] { return reports_.value("state") == state; });
  }

  const std::string name_;
  ros::NodeHandle node_;
  nodelet::Loader loader_;
  Reports reports_;
};

TEST_F(CaptureNodeletTest, PublishesDepthWithItsCamera) {
  playFrames(1);
  std::ofstream(folder / "camera_info.yaml")
      << "camera_matrix: {rows: 3, cols: 3, data: [131.25, 0, 79.5, 0, 140.5, 59.5, 0, 0, 1]}\n";
  start();
  Listener<Image> images(node_, "depth/image_raw");
  Listener<CameraInfo> infos(node_, "depth/camera_info");
  const auto image = first(images);
  ASSERT_TRUE(image);
  EXPECT_EQ(image->encoding, "16UC1");
  EXPECT_EQ(image->width, 160u);
  EXPECT_EQ(image->height, 120u);
  EXPECT_EQ(image->step, 320u);
  EXPECT_EQ(image->is_bigendian, 0);
  EXPECT_EQ(image->header.frame_id, "voxid_depth_optical_frame");
  EXPECT_LT(std::abs((ros::Time::now() - image->header.stamp).toSec()), 5);
  const cv::Mat expected = depthImage(0);
  ASSERT_EQ(image->data.size(), expected.total() * 2);
  EXPECT_EQ(std::memcmp(image->data.data(), expected.data, image->data.size()), 0);

  boost::shared_ptr<const CameraInfo> info;
  ASSERT_TRUE(test::eventually(10, [&] {
    return (info = infos.find([&](const ros::Time& stamp) { return images.wait(stamp, 0) != nullptr; })) != nullptr;
  }));
  EXPECT_EQ(info->header.frame_id, "voxid_depth_optical_frame");
  EXPECT_EQ(info->width, 160u);
  EXPECT_EQ(info->height, 120u);
  const double k[] = {131.25, 0, 79.5, 0, 140.5, 59.5, 0, 0, 1};
  EXPECT_TRUE(std::equal(info->K.begin(), info->K.end(), k));
  const double p[] = {131.25, 0, 79.5, 0, 0, 140.5, 59.5, 0, 0, 0, 1, 0};
  EXPECT_TRUE(std::equal(info->P.begin(), info->P.end(), p));
}

TEST_F(CaptureNodeletTest, RunsFromTheFirstListenerToTheLast) {
  playFrames(2);
  start();
  ASSERT_TRUE(stateBecomes("idle"));
  EXPECT_EQ(reports_.value("frames"), "0");
  {
    Listener<CameraInfo> infos(node_, "depth/camera_info");
    ASSERT_TRUE(moreCome(infos));
    Listener<Image> images(node_, "depth/image_raw");
    ASSERT_TRUE(moreCome(images));
    ASSERT_TRUE(stateBecomes("running"));
  }
  ASSERT_TRUE(stateBecomes("idle"));
  const std::string frames = reports_.value("frames");
  ros::WallDuration(1.5).sleep();  // two reports later
  EXPECT_EQ(reports_.value("frames"), frames);
  Listener<Image> images(node_, "depth/image_raw");
  EXPECT_TRUE(moreCome(images));
}

TEST_F(CaptureNodeletTest, RecoversFromADisconnectWithOneErrorAndAWarning) {
  playFrames(2);
  useControl();
  start();
  Listener<Image> images(node_, "depth/image_raw");
  ASSERT_TRUE(moreCome(images));
  command("unplug");
  ASSERT_TRUE(stateBecomes("lost"));
  EXPECT_EQ(reports_.level(), diagnostic_msgs::DiagnosticStatus::WARN);
  EXPECT_NE(reports_.value("cause").find("no device"), std::string::npos) << reports_.value("cause");
  ros::WallDuration(1).sleep();  // vain tries that must not be told
  ASSERT_EQ(reports_.errors().size(), 1u);
  EXPECT_NE(reports_.errors()[0].find("was disconnected"), std::string::npos);
  command("replug");
  ASSERT_TRUE(moreCome(images));
  ASSERT_TRUE(stateBecomes("running"));
  EXPECT_EQ(reports_.level(), diagnostic_msgs::DiagnosticStatus::OK);
  EXPECT_EQ(reports_.value("reconnects"), "1");
  EXPECT_EQ(reports_.errors().size(), 1u);
}

TEST_F(CaptureNodeletTest, StampsColourAndDepthAlike) {
  playFrames(3, true);
  node_.setParam("capture/color", true);
  start();
  Listener<Image> depth(node_, "depth/image_raw"), colour(node_, "rgb/image_raw");
  boost::shared_ptr<const Image> rgb;
  ASSERT_TRUE(test::eventually(10, [&] {
    return (rgb = colour.find([&](const ros::Time& stamp) { return depth.wait(stamp, 0) != nullptr; })) != nullptr;
  }));
  EXPECT_EQ(rgb->encoding, "rgb8");
  EXPECT_EQ(rgb->step, 480u);
  EXPECT_EQ(rgb->data[0], 200);
  EXPECT_EQ(rgb->data[1], 100);
}

// A simulation that has not begun has the time zero, and an offset leads before it.
TEST_F(CaptureNodeletTest, NoStampLiesBeforeTimeZero) {
  playFrames(2);
  node_.setParam("capture/stamp_offset_ms", -200);
  ros::Time::setNow(ros::Time());
  {
    start();
    Listener<Image> images(node_, "depth/image_raw");
    const auto image = first(images);
    EXPECT_TRUE(image && image->header.stamp.isZero());
  }
  ros::Time::init();  // the clock's time again
}

TEST_F(CaptureNodeletTest, TakesACalibrationFile) {
  playFrames(1);
  std::ofstream(folder / "mine.yaml")
      << "image_width: 160\nimage_height: 120\ncamera_name: depth\n"
         "camera_matrix: {rows: 3, cols: 3, data: [130, 0, 81, 0, 131, 58, 0, 0, 1]}\n"
         "distortion_model: plumb_bob\ndistortion_coefficients: {rows: 1, cols: 5, data: [0.1, 0, 0, 0, 0]}\n"
         "rectification_matrix: {rows: 3, cols: 3, data: [1, 0, 0, 0, 1, 0, 0, 0, 1]}\n"
         "projection_matrix: {rows: 3, cols: 4, data: [130, 0, 81, 0, 0, 131, 58, 0, 0, 0, 1, 0]}\n";
  node_.setParam("capture/camera_info_url", "file://" + (folder / "mine.yaml"));
  start();
  Listener<CameraInfo> infos(node_, "depth/camera_info");
  const auto info = first(infos);
  ASSERT_TRUE(info);
  EXPECT_EQ(info->K[0], 130);
  EXPECT_EQ(info->K[2], 81);
  EXPECT_EQ(info->D[0], 0.1);
}

TEST_F(CaptureNodeletTest, SaysThatACalibrationFileIsMissing) {
  playFrames(1);
  node_.setParam("capture/camera_info_url", "file:///no/such/file.yaml");
  start();
  Listener<CameraInfo> infos(node_, "depth/camera_info");
  const auto info = first(infos);
  ASSERT_TRUE(info);
  EXPECT_EQ(info->K[0], 131.25);  // 525 at 640 columns
  EXPECT_TRUE(test::eventually(10, [&] { return reports_.level() == diagnostic_msgs::DiagnosticStatus::WARN; }));
}

TEST_F(CaptureNodeletTest, CopiesNothingOnTheWayToClassification) {
  playFrames(2);
  for (const char* nodelet : {"capture", "segmentation", "classification"}) start(nodelet);
  Listener<Objects> objects(node_, "objects");
  ASSERT_TRUE(moreCome(objects));
  const auto received = classified.all();  // first: whatever was classified has been captured before
  const auto sent = captured.all();
  std::set<const void*> addresses;
  ASSERT_GE(received.size(), 3u);
  for (const auto& [stamp, address] : received) {
    ASSERT_EQ(sent.count(stamp), 1u);
    EXPECT_EQ(address, sent.at(stamp));
    addresses.insert(address);
  }
}

pid_t startNode(const std::string& ns) {
  const pid_t child = fork();
  if (child != 0) return child;
  setenv("ROS_NAMESPACE", ns.c_str(), 1);
  execl(VOXID_NODES "/voxid_capture", "voxid_capture", static_cast<char*>(nullptr));
  _exit(127);
}

TEST_F(CaptureNodeletTest, IsANodeThatEndsCleanlyOnInterrupt) {
  playFrames(2);
  const pid_t child = startNode(name_);
  Listener<Image> images(node_, "depth/image_raw");
  EXPECT_TRUE(moreCome(images));
  kill(child, SIGINT);
  int status = -1;
  ASSERT_TRUE(test::eventually(10, [&] { return waitpid(child, &status, WNOHANG) == child; }));
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

TEST_F(CaptureNodeletTest, TheChainSurvivesADeviceThatUnplugsInMidFrame) {
  playFrames(2);
  useControl();
  for (const char* nodelet : {"capture", "segmentation", "classification"}) start(nodelet);
  Listener<Objects> objects(node_, "objects");
  ASSERT_TRUE(moreCome(objects));
  for (int round = 1; round <= 3; ++round) {
    command("corrupt 1");  // half a frame, and the device is gone
    ASSERT_TRUE(test::eventually(10, [&] { return reports_.value("bad_frames") == std::to_string(round); }));
    command("unplug");
    ASSERT_TRUE(stateBecomes("lost"));
    command("replug");
    ASSERT_TRUE(moreCome(objects)) << round;
  }
  EXPECT_TRUE(test::eventually(10, [&] { return reports_.value("reconnects") == "3"; }))
      << reports_.value("reconnects");
}

TEST_F(CaptureNodeletTest, EveryParameterWorksWhileItRuns) {
  playFrames(2);
  useControl();
  start();
  Listener<Image> images(node_, "depth/image_raw");
  ASSERT_TRUE(moreCome(images));
  const auto set = [&](const char* name, int value) {
    dynamic_reconfigure::Reconfigure change;
    change.request.config.ints.resize(1);
    change.request.config.ints[0].name = name;
    change.request.config.ints[0].value = value;
    ASSERT_TRUE(ros::service::call(name_ + "/capture/set_parameters", change)) << name;
  };

  // The offset comes into effect between these two moments.
  const ros::Time asked = ros::Time::now(), later = asked + ros::Duration(0.2);
  set("stamp_offset_ms", 200);
  const ros::Time changed = ros::Time::now();
  const auto stampIn = [&](const ros::Time& begin, const ros::Time& end) {
    return images.find([&](const ros::Time& stamp) { return stamp > begin && stamp < end; }) != nullptr;
  };
  EXPECT_TRUE(test::eventually(10, [&] { return stampIn(later, later + ros::Duration(10)); }));
  EXPECT_FALSE(stampIn(changed, later)) << "of a frame before which the offset was set";
  set("stamp_offset_ms", 0);

  const auto stallFor = [&](const char* line) {
    command(line);
    ros::WallDuration(0.1).sleep();
    EXPECT_TRUE(moreCome(images)) << line;
  };
  set("stall_ms", 60000);
  stallFor(("stall " + std::to_string(kStall_ms + 300)).c_str());
  ros::WallDuration(1.2).sleep();
  EXPECT_EQ(reports_.value("reconnects"), "0");
  set("stall_ms", 600);
  stallFor("stall 1500");
  EXPECT_TRUE(test::eventually(5, [&] { return reports_.value("reconnects") != "0"; }));
  set("stall_ms", kStall_ms);

  set("retry_first_ms", 60000);
  command("unplug 100");
  ASSERT_TRUE(stateBecomes("lost"));
  const std::size_t before = images.count();
  ros::WallDuration(0.6).sleep();  // the device is back for longer than retry_most_ms was
  EXPECT_EQ(images.count(), before);
  set("retry_first_ms", 20);  // then retry_most_ms, 200, is the longest wait
  EXPECT_TRUE(moreCome(images));

  set("retry_most_ms", 60000);
  set("retry_first_ms", 1000);  // tries after 1, 3 and 7 s; were 200 ms the longest wait, after 1, 2, 3, 4, 5 and so on
  const ros::WallTime begin = ros::WallTime::now();
  command("unplug");
  ASSERT_TRUE(stateBecomes("lost"));
  ros::WallTime::sleepUntil(begin + ros::WallDuration(4.5));
  command("replug");
  const std::size_t still = images.count();
  ros::WallTime::sleepUntil(begin + ros::WallDuration(6));
  EXPECT_EQ(images.count(), still);
  set("retry_first_ms", 20);
  set("retry_most_ms", 20);
  EXPECT_TRUE(moreCome(images));
}

/// The whole chain in one manager.
pid_t startManager() {
  const pid_t child = fork();
  if (child != 0) return child;
  execl(VOXID_BIN "/voxid_chain_bench", "voxid_chain_bench", "--manager", static_cast<char*>(nullptr));
  _exit(127);
}

TEST_F(CaptureNodeletTest, TheWholeChainEndsCleanlyOnInterruptAtAnyMomentOfAFrame) {
  playFrames(2);
  const ros::NodeHandle node("/voxid");
  node.setParam("lcm_bridge/url", "udpm://239.255.76.67:7744?ttl=0");
  for (const double moment_ms : {0.0, 9.0, 18.0, 27.0}) {
    const pid_t child = startManager();
    Listener<Objects> objects(node, "objects");
    EXPECT_TRUE(moreCome(objects));
    ros::WallDuration(moment_ms * 1e-3).sleep();
    kill(child, SIGINT);
    int status = -1;
    const bool ended = test::eventually(10, [&] { return waitpid(child, &status, WNOHANG) == child; });
    if (!ended) kill(child, SIGKILL);
    ASSERT_TRUE(ended) << moment_ms;
    ASSERT_TRUE(WIFEXITED(status)) << moment_ms << ": signal " << WTERMSIG(status);
    EXPECT_EQ(WEXITSTATUS(status), 0) << moment_ms;
  }
}

}  // namespace
}  // namespace voxid

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "capture_nodelet_test");
  return voxid::test::runAll();
}
