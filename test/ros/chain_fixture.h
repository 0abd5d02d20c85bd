// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dynamic_reconfigure/Reconfigure.h>
#include <gtest/gtest.h>
#include <nodelet/loader.h>
#include <ros/ros.h>
#include <unistd.h>

#include <boost/make_shared.hpp>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "classification_nodelet.h"
#include "listener.h"
#include "overlay_nodelet.h"
#include "points_nodelet.h"
#include "segmentation_nodelet.h"
#include "table_scene.h"

namespace voxid::test {

/// Sets a parameter of a nodelet as `rosrun dynamic_reconfigure dynparam` does.
inline void reconfigure(const std::string& nodelet, const std::string& name, bool boolean, int value) {
  dynamic_reconfigure::Reconfigure change;
  if (boolean) {
    change.request.config.bools.resize(1);
    change.request.config.bools[0].name = name;
    change.request.config.bools[0].value = static_cast<std::uint8_t>(value);
  } else {
    change.request.config.ints.resize(1);
    change.request.config.ints[0].name = name;
    change.request.config.ints[0].value = value;
  }
  ASSERT_TRUE(ros::service::call(nodelet + "/set_parameters", change)) << name;
}

/// The first object with a label; null if there is none.
inline const Object* labelled(const Objects& objects, const std::string& label) {
  for (const Object& object : objects.objects)
    if (object.label == label) return &object;
  return nullptr;
}

/// Segmentation, classification and overlay in a namespace of the test's own, and a camera that shows what it is told
/// to.
class Chain : public testing::Test {
 public:
  /// A test may take a classification of its own.
  static inline std::function<boost::shared_ptr<nodelet::Nodelet>()> makeClassification = [] {
    return boost::make_shared<ClassificationNodelet>();
  };

 protected:
  Chain()
      : name_(std::string("/") + testing::UnitTest::GetInstance()->current_test_info()->name()),
        node_(name_),
        index_path_(std::filesystem::temp_directory_path() / (name_.substr(1) + std::to_string(getpid()) + ".vxi")),
        loader_(boost::function<boost::shared_ptr<nodelet::Nodelet>(const std::string&)>(create)),
        image_(node_.advertise<sensor_msgs::Image>("depth/image_raw", 4)),
        info_(node_.advertise<sensor_msgs::CameraInfo>("depth/camera_info", 4)) {
    node_.setParam("classification/index", index_path_.string());
  }
  ~Chain() override {
    loader_.clear();
    std::filesystem::remove(index_path_);
  }

  static boost::shared_ptr<nodelet::Nodelet> create(const std::string& type) {
    if (type == "voxid/points") return boost::make_shared<PointsNodelet>();
    if (type == "voxid/segmentation") return boost::make_shared<SegmentationNodelet>();
    if (type == "voxid/classification") return makeClassification();
    return boost::make_shared<OverlayNodelet>();
  }

  void start() {
    for (const std::string nodelet : {"segmentation", "classification", "overlay"})
      ASSERT_TRUE(loader_.load(name_ + "/" + nodelet, "voxid/" + nodelet, {}, {}));
  }

  ros::Time show(const std::vector<std::uint16_t>& depth_mm) {
    const ros::Time stamp = ros::Time::now();
    sent_ = imageOf(depth_mm, stamp);
    image_.publish(sent_);
    info_.publish(infoOf(stamp));
    return stamp;
  }

  /// Shows the frame until the chain, which connects in its own time, has answered one of them.
  template <typename M>
  boost::shared_ptr<const M> answerTo(const std::vector<std::uint16_t>& depth_mm, Listener<M>& listener) {
    boost::shared_ptr<const M> answer;
    eventually(10, [&] { return (answer = listener.wait(show(depth_mm), 0.5)) != nullptr; });
    return answer;
  }
  ObjectsConstPtr objectsFor(const std::vector<std::uint16_t>& depth_mm) {
    Listener<Objects> listener(node_, "objects");
    return answerTo(depth_mm, listener);
  }

  const std::string name_;
  ros::NodeHandle node_;
  const std::filesystem::path index_path_;
  nodelet::Loader loader_;
  ros::Publisher image_, info_;
  sensor_msgs::ImageConstPtr sent_;
};

}  // namespace voxid::test
