// SPDX-License-Identifier: BSD-3-Clause
// Cameras that send nonsense, clocks that jump, listeners that sleep: the chain answers on, with the newest frame.
#include <diagnostic_msgs/DiagnosticArray.h>
#include <ros/callback_queue.h>
#include <rosgraph_msgs/Log.h>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "chain_fixture.h"
#include "scene_index.h"

namespace voxid {
namespace {

using test::eventually;
using test::imageOf;
using test::infoOf;
using test::Listener;
using test::TableScene;

constexpr std::uint32_t kWidth = TableScene::kWidth, kHeight = TableScene::kHeight;

/// Classification that takes its time.
class SlowClassification : public ClassificationNodelet {
 public:
  static std::atomic<int> delay_ms;

 protected:
  void onFrame(const sensor_msgs::ImageConstPtr& image, const sensor_msgs::CameraInfoConstPtr& info,
               const SegmentsConstPtr& segments) override {
    ros::WallDuration(delay_ms / 1e3).sleep();
    ClassificationNodelet::onFrame(image, info, segments);
  }
};
std::atomic<int> SlowClassification::delay_ms{0};

struct Faults : test::Chain {
  Faults() { SlowClassification::delay_ms = 0; }

  /// A running chain that has answered a first frame.
  void startAnswering() {
    test::writeSceneIndex(index_path_);
    start();
    objects_ = std::make_unique<Listener<Objects>>(node_, "objects");
    ASSERT_TRUE(answerTo(TableScene().depth_mm(), *objects_));
  }
  ros::Time show(const sensor_msgs::ImagePtr& image, const sensor_msgs::CameraInfoPtr& info) {
    image_.publish(image);
    info_.publish(info);
    return image->header.stamp;
  }
  ObjectsConstPtr answerTo(const sensor_msgs::ImagePtr& image, const sensor_msgs::CameraInfoPtr& info) {
    return objects_->wait(show(image, info), 5);
  }
  using Chain::answerTo;
  ObjectsConstPtr answerToTheScene(const ros::Time& stamp = ros::Time::now()) {
    return answerTo(imageOf(TableScene().depth_mm(), stamp), infoOf(stamp));
  }
  void expectTheSceneIsSeen(const ros::Time& stamp = ros::Time::now()) {
    const ObjectsConstPtr objects = answerToTheScene(stamp);
    ASSERT_TRUE(objects);
    EXPECT_EQ(objects->status, Objects::OK + 0) << objects->status_text;
    EXPECT_EQ(objects->objects.size(), 2u);
  }

  std::unique_ptr<Listener<Objects>> objects_;
};

sensor_msgs::ImagePtr floatImage(const std::vector<float>& depth_m, const ros::Time& stamp) {
  const auto image = imageOf({}, stamp);
  image->encoding = "32FC1";
  image->step = image->width * 4;
  image->data.resize(depth_m.size() * 4);
  std::memcpy(image->data.data(), depth_m.data(), image->data.size());
  return image;
}

std::vector<float> metres(const std::vector<std::uint16_t>& depth_mm) {
  std::vector<float> depth_m;
  for (const std::uint16_t mm : depth_mm)
    depth_m.push_back(mm == 0 ? std::numeric_limits<float>::quiet_NaN() : mm / 1000.0f);
  return depth_m;
}

/// The scene at another size: every pixel shown twice both ways, or every second one left out.
struct Sized {
  sensor_msgs::ImagePtr image;
  sensor_msgs::CameraInfoPtr info;
};
Sized sized(double scale, const ros::Time& stamp) {
  const std::vector<std::uint16_t> scene = TableScene().depth_mm();
  Sized out{imageOf({}, stamp), infoOf(stamp)};
  const auto width = static_cast<std::uint32_t>(kWidth * scale), height = static_cast<std::uint32_t>(kHeight * scale);
  std::vector<std::uint16_t> depth_mm(width * height);
  for (std::uint32_t v = 0; v < height; ++v)
    for (std::uint32_t u = 0; u < width; ++u)
      depth_mm[v * width + u] =
          scene[static_cast<std::uint32_t>(v / scale) * kWidth + static_cast<std::uint32_t>(u / scale)];
  out.image->width = out.info->width = width;
  out.image->height = out.info->height = height;
  out.image->step = width * 2;
  const auto* const bytes = reinterpret_cast<const std::uint8_t*>(depth_mm.data());
  out.image->data.assign(bytes, bytes + depth_mm.size() * 2);
  for (const std::size_t k : {0u, 2u, 4u, 5u}) out.info->K[k] *= scale;
  return out;
}

TEST_F(Faults, FloatDepthIsReadAsMetresAndNanAsNothing) {
  startAnswering();
  const ObjectsConstPtr from_mm = answerToTheScene();
  ASSERT_TRUE(from_mm);
  const ros::Time stamp = ros::Time::now();
  const ObjectsConstPtr from_m = answerTo(floatImage(metres(TableScene().depth_mm()), stamp), infoOf(stamp));
  ASSERT_TRUE(from_m);
  ASSERT_EQ(from_m->objects.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(from_m->objects[i].label, from_mm->objects[i].label);
    EXPECT_EQ(from_m->objects[i].points, from_mm->objects[i].points);
    EXPECT_NEAR(from_m->objects[i].centroid.z, from_mm->objects[i].centroid.z, 1e-4);
  }

  const std::vector<float> nowhere(kWidth * kHeight, std::numeric_limits<float>::quiet_NaN());
  const ros::Time later = ros::Time::now();
  const ObjectsConstPtr none = answerTo(floatImage(nowhere, later), infoOf(later));
  ASSERT_TRUE(none);
  EXPECT_EQ(none->status, Objects::NO_DEPTH + 0);
  EXPECT_TRUE(none->objects.empty());
  EXPECT_TRUE(none->table.outline.empty());  // nothing is left of the frame before
}

TEST_F(Faults, InfiniteNegativeAndHugeDepthsAreNothing) {
  startAnswering();
  std::vector<float> depth_m = metres(TableScene().depth_mm());
  const float odd[] = {std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity(), -0.8f, 1e30f,
                       std::numeric_limits<float>::denorm_min()};
  for (std::size_t i = 0; i < depth_m.size(); i += 9) depth_m[i] = odd[i / 9 % 5];
  const ros::Time stamp = ros::Time::now();
  const ObjectsConstPtr objects = answerTo(floatImage(depth_m, stamp), infoOf(stamp));
  ASSERT_TRUE(objects);
  EXPECT_EQ(objects->status, Objects::OK + 0) << objects->status_text;
  EXPECT_EQ(objects->objects.size(), 2u);
  EXPECT_NEAR(objects->table.distance_m, TableScene().height_m, 0.005);
}

TEST_F(Faults, AllZeroFramesComeAndGo) {
  startAnswering();
  for (int round = 0; round < 3; ++round) {
    const ros::Time stamp = ros::Time::now();
    const ObjectsConstPtr dark =
        answerTo(imageOf(std::vector<std::uint16_t>(kWidth * kHeight, 0), stamp), infoOf(stamp));
    ASSERT_TRUE(dark);
    EXPECT_EQ(dark->status, Objects::NO_DEPTH + 0);
    EXPECT_TRUE(dark->objects.empty());
    expectTheSceneIsSeen();
  }
}

TEST_F(Faults, FramesMayChangeTheirSize) {
  startAnswering();
  for (const double scale : {1.0, 2.0, 0.5, 1.0, 0.5, 2.0}) {
    const Sized frame = sized(scale, ros::Time::now());
    const ObjectsConstPtr objects = answerTo(frame.image, frame.info);
    ASSERT_TRUE(objects) << scale;
    EXPECT_EQ(objects->status, Objects::OK + 0) << scale << ": " << objects->status_text;
    ASSERT_EQ(objects->objects.size(), 2u) << scale;
    EXPECT_NEAR(objects->table.distance_m, TableScene().height_m, 0.005) << scale;
    EXPECT_NEAR(objects->objects[0].extents_m.z, 0.12, 0.02) << scale;
  }
}

TEST_F(Faults, AnImageShorterThanItSaysIsRefused) {
  startAnswering();
  const ros::Time stamp = ros::Time::now();
  const auto image = imageOf(TableScene().depth_mm(), stamp);
  image->data.resize(image->data.size() / 2);  // as an unplugged device may leave it
  const ObjectsConstPtr objects = answerTo(image, infoOf(stamp));
  ASSERT_TRUE(objects);
  EXPECT_EQ(objects->status, Objects::BAD_INPUT + 0);
  EXPECT_NE(objects->status_text.find("76800 bytes in rows of 640"), std::string::npos) << objects->status_text;
  expectTheSceneIsSeen();
}

TEST_F(Faults, CameraInfoOfAnotherSizeIsRefused) {
  startAnswering();
  const ros::Time stamp = ros::Time::now();
  const auto info = infoOf(stamp);
  info->width = 640;
  info->height = 480;
  const ObjectsConstPtr objects = answerTo(imageOf(TableScene().depth_mm(), stamp), info);
  ASSERT_TRUE(objects);
  EXPECT_EQ(objects->status, Objects::BAD_INPUT + 0);
  EXPECT_NE(objects->status_text.find("camera_info is for 640 x 480, the depth image is 320 x 240"), std::string::npos)
      << objects->status_text;
  EXPECT_TRUE(objects->objects.empty());
  expectTheSceneIsSeen();
}

TEST_F(Faults, TimeMayGoBackwards) {
  startAnswering();
  const ros::Time now = ros::Time::now();
  for (const double step : {0.0, -100.0, -99.9, -3600.0, 5.0, -0.001}) expectTheSceneIsSeen(now + ros::Duration(step));
}

/// What was logged so far.
class Log {
 public:
  Log() {
    subscriber_ = ros::NodeHandle().subscribe("/rosout", 200, &Log::on, this);
    EXPECT_TRUE(eventually(5, [this] { return subscriber_.getNumPublishers() > 0; }));
  }
  /// Lines that begin and go on so.
  std::ptrdiff_t count(const std::string& begin, const std::string& part = "") {
    const std::lock_guard<std::mutex> lock(mutex_);
    return std::count_if(lines_.begin(), lines_.end(), [&](const std::string& line) {
      return line.compare(0, begin.size(), begin) == 0 && line.find(part) != std::string::npos;
    });
  }

 private:
  void on(const rosgraph_msgs::LogConstPtr& line) {
    const std::lock_guard<std::mutex> lock(mutex_);
    lines_.push_back(line->msg);
  }

  std::mutex mutex_;
  std::vector<std::string> lines_;
  ros::Subscriber subscriber_;
};

// As from a command line that says _size:=1.
TEST_F(Faults, AParameterOfAnotherTypeIsNamed) {
  Log log;
  node_.setParam("classification/size", 1);
  node_.setParam("segmentation/max_clusters", "many");
  startAnswering();
  for (const char* sentence : {"/classification/size is not true or false: the default is taken",
                               "/segmentation/max_clusters is not a number: the default is taken"})
    EXPECT_TRUE(eventually(5, [&] { return log.count(name_ + sentence) > 0; })) << sentence;
}

struct LoggedFaults : Faults {
  void showWrongEncoding() {
    const ros::Time stamp = ros::Time::now();
    const auto image = imageOf(TableScene().depth_mm(), stamp);
    image->encoding = "bgr8";
    const ObjectsConstPtr objects = answerTo(image, infoOf(stamp));
    ASSERT_TRUE(objects && objects->status == Objects::BAD_INPUT);
  }
  void expectIsLoggedOnce(const std::string& nodelet) {
    const auto lines = [&] { return log_.count(name_ + "/" + nodelet + ": ", "'bgr8'"); };
    EXPECT_TRUE(eventually(5, [&] { return lines() > 0; }));
    ros::WallDuration(0.5).sleep();
    EXPECT_EQ(lines(), 1) << nodelet;
  }

  Log log_;
};

TEST_F(LoggedFaults, WhatIsWrongInEverySecondFrameIsLoggedOnce) {
  startAnswering();
  for (int i = 0; i < 5; ++i) {
    showWrongEncoding();
    expectTheSceneIsSeen();
  }
  expectIsLoggedOnce("segmentation");
}

TEST_F(LoggedFaults, WhatIsWrongInEveryFrameIsLoggedOnceWhereThereIsNoIndexEither) {
  start();
  objects_ = std::make_unique<Listener<Objects>>(node_, "objects");
  ASSERT_TRUE(answerTo(TableScene().depth_mm(), *objects_));
  for (int i = 0; i < 5; ++i) showWrongEncoding();
  expectIsLoggedOnce("classification");
}

// As of a driver that never set them; ros::Time's own differences throw.
TEST_F(Faults, StampsMayLieAnyDistanceFromTheClock) {
  startAnswering();
  for (const ros::Time& stamp : {ros::Time(0, 1), ros::Time(0x80000000u, 0), ros::TIME_MAX})
    expectTheSceneIsSeen(stamp);
  ros::WallDuration(1.2).sleep();  // the diagnostics say how old the last frame is
  expectTheSceneIsSeen();
}

// What waits for its other half must not keep older stamps out for ever.
TEST_F(Faults, TimeMayGoBackwardsWhileHalfAFrameIsMissing) {
  startAnswering();
  const ros::Time now = ros::Time::now();
  for (int i = 0; i < 12; ++i) {
    image_.publish(imageOf(TableScene().depth_mm(), now + ros::Duration(0.01 * i)));
    ros::WallDuration(0.03).sleep();
  }
  ObjectsConstPtr objects;
  int shown = 0;
  eventually(5, [&] {
    ++shown;
    const ros::Time stamp = now - ros::Duration(60 - 0.1 * shown);
    objects = objects_->wait(show(imageOf(TableScene().depth_mm(), stamp), infoOf(stamp)), 0.3);
    return objects != nullptr;
  });
  ASSERT_TRUE(objects) << "after " << shown << " frames";
  EXPECT_EQ(objects->objects.size(), 2u);
}

TEST_F(Faults, WithoutTransformPosesStayAndTheReasonIsInTheDiagnostics) {
  node_.setParam("classification/target_frame", "nowhere");
  std::mutex mutex;
  std::string reason;
  const ros::Subscriber subscriber = node_.subscribe<diagnostic_msgs::DiagnosticArray>(
      "/diagnostics", 50, [&](const diagnostic_msgs::DiagnosticArrayConstPtr& array) {
        const std::lock_guard<std::mutex> lock(mutex);
        for (const auto& status : array->status)
          if (status.name == name_.substr(1) + "/classification: frames") reason = status.message;
      });
  startAnswering();
  const ros::WallTime before = ros::WallTime::now();
  const ObjectsConstPtr objects = answerToTheScene();
  EXPECT_LT((ros::WallTime::now() - before).toSec(), 2);  // the lookup does not wait
  ASSERT_TRUE(objects);
  EXPECT_EQ(objects->status, Objects::NO_TRANSFORM + 0);
  EXPECT_EQ(objects->header.frame_id, "camera");
  EXPECT_EQ(objects->objects.size(), 2u);
  EXPECT_TRUE(eventually(5, [&] {
    const std::lock_guard<std::mutex> lock(mutex);
    return reason.find("no transform from 'camera' to 'nowhere'") != std::string::npos;
  })) << reason;
}

TEST_F(Faults, AListenerThatSleepsHoldsNobodyUp) {
  startAnswering();
  ros::NodeHandle sleeper(node_);
  ros::CallbackQueue never_called;
  sleeper.setCallbackQueue(&never_called);
  std::vector<ros::Time> heard;
  const ros::Subscriber subscriber = sleeper.subscribe<Objects>(
      "objects", 3, [&](const ObjectsConstPtr& objects) { heard.push_back(objects->header.stamp); });
  ASSERT_TRUE(eventually(5, [&] { return subscriber.getNumPublishers() > 0; }));
  ros::Time last;
  for (int i = 0; i < 40; ++i) {
    last = ros::Time::now();
    expectTheSceneIsSeen(last);
  }
  ros::WallDuration(0.2).sleep();  // the last one reaches the listeners one after the other
  never_called.callAvailable();
  ASSERT_LE(heard.size(), 3u);  // nothing has grown
  ASSERT_FALSE(heard.empty());
  EXPECT_EQ(heard.back(), last);  // and the newest is there
}

TEST_F(Faults, ABusyChainGoesOnWithTheNewestFrameAndCountsTheOthers) {
  startAnswering();
  std::mutex mutex;
  int dropped = 0;
  const ros::Subscriber subscriber = node_.subscribe<diagnostic_msgs::DiagnosticArray>(
      "/diagnostics", 50, [&](const diagnostic_msgs::DiagnosticArrayConstPtr& array) {
        const std::lock_guard<std::mutex> lock(mutex);
        for (const auto& status : array->status)
          for (const auto& pair : status.values)
            if (status.name == name_.substr(1) + "/classification: frames" && pair.key == "dropped")
              dropped = std::stoi(pair.value);
      });
  SlowClassification::delay_ms = 300;
  const std::size_t before = objects_->count();
  ros::Time last;
  constexpr int kShown = 30;
  for (int i = 0; i < kShown; ++i) {
    last = show(imageOf(TableScene().depth_mm(), ros::Time::now()), infoOf(ros::Time(0)));
    ros::WallDuration(0.033).sleep();
  }
  EXPECT_EQ(objects_->count(), before);  // a camera_info of another stamp belongs to none of them
  for (int i = 0; i < kShown; ++i) {
    const ros::Time stamp = ros::Time::now();
    last = show(imageOf(TableScene().depth_mm(), stamp), infoOf(stamp));
    ros::WallDuration(0.033).sleep();
  }
  ASSERT_TRUE(objects_->wait(last, 5));
  const std::size_t answered = objects_->count() - before;
  EXPECT_GE(answered, 2u);
  EXPECT_LE(answered, 12u);  // 1 s of frames, 0.3 s each, and the newest
  EXPECT_TRUE(eventually(5, [&] {
    const std::lock_guard<std::mutex> lock(mutex);
    return dropped >= kShown - static_cast<int>(answered) - 2;
  })) << dropped;
}

}  // namespace
}  // namespace voxid

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "faults_test");
  voxid::test::Chain::makeClassification = [] { return boost::make_shared<voxid::SlowClassification>(); };
  return voxid::test::runAll();
}
