// SPDX-License-Identifier: BSD-3-Clause
// Which categories are answers: those of a list, those of an object's size, and the one that somebody confirmed.
#include <gtest/gtest.h>
#include <ros/ros.h>
#include <voxid/ConfirmObject.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "chain_fixture.h"
#include "scene_index.h"
#include "voxid/library/confirmed_sizes.h"

namespace voxid {
namespace {

using test::Chain;
using test::labelled;
using test::Listener;
using test::TableScene;

TEST_F(Chain, OnlyListedCategoriesAreAnswers) {
  test::writeSceneIndex(index_path_);
  const std::string list = index_path_.string() + ".txt";
  std::ofstream(list) << "ball\n";
  node_.setParam("classification/categories", list);
  start();
  const ObjectsConstPtr objects = objectsFor(TableScene().depth_mm());
  std::filesystem::remove(list);
  ASSERT_TRUE(objects && objects->objects.size() == 2);
  for (const Object& object : objects->objects) {
    EXPECT_EQ(object.label, "ball");
    ASSERT_EQ(object.alternatives.size(), 1u);
  }
}

TEST_F(Chain, WhatCannotBeSoShortIsNoAnswer) {
  test::writeSceneIndex(index_path_, "bed");  // cfg/sizes.yaml: at least 50 cm
  node_.setParam("classification/size", true);
  start();
  const ObjectsConstPtr objects = objectsFor(TableScene().depth_mm());
  ASSERT_TRUE(objects && objects->objects.size() == 2);
  for (const Object& object : objects->objects) EXPECT_EQ(object.label, "ball");
}

TEST_F(Chain, AConfirmedSizeIsKeptAndCounts) {
  test::writeSceneIndex(index_path_, "bed");  // cfg/sizes.yaml: at least 50 cm
  const std::string kept = index_path_.string() + "-sizes.yaml";
  std::filesystem::remove(kept);
  node_.setParam("classification/size", true);
  node_.setParam("classification/confirmed_sizes", kept);
  start();
  TableScene scene;
  ObjectsConstPtr objects = objectsFor(scene.depth_mm());
  ASSERT_TRUE(objects && objects->objects.size() == 2);
  const bool box_first = objects->objects[0].pose.pose.position.x < objects->objects[1].pose.pose.position.x;
  ConfirmObject call;
  const auto confirm = [&](std::uint32_t number, const std::string& category) {
    call.request.number = number;
    call.request.category = category;
    EXPECT_TRUE(ros::service::call(name_ + "/confirm_object", call));
    return call.response.success != 0;
  };
  const std::uint32_t number = objects->objects[box_first ? 0 : 1].number;
  EXPECT_FALSE(confirm(77, "bed"));
  EXPECT_EQ(call.response.message, "the newest frame shows no object with number 77");
  EXPECT_FALSE(confirm(number, "toy bed"));
  EXPECT_EQ(call.response.message, "the index has no category 'toy bed'");
  EXPECT_TRUE(confirm(number, "bed")) << call.response.message;
  const std::vector<int> longest_mm = ConfirmedSizes::read(kept).value.longest_mm().at("bed");
  ASSERT_EQ(longest_mm.size(), 1u);
  EXPECT_NEAR(longest_mm[0], 165, 20) << "what is seen of 10 x 8 x 12 cm";

  scene.boxes[0].centre_m.x() -= 0.08;  // what is new is named by the frames from now on
  EXPECT_TRUE(test::eventually(10, [&] {
    objects = objectsFor(scene.depth_mm());
    return objects && labelled(*objects, "bed");
  }));
  std::ofstream(kept) << "damaged";
  ASSERT_TRUE(objects);
  EXPECT_FALSE(confirm(labelled(*objects, "bed") ? labelled(*objects, "bed")->number : 0, "bed"));
  EXPECT_NE(call.response.message.find("no file of confirmed sizes"), std::string::npos) << call.response.message;
  std::filesystem::remove(kept);
}

/// Says that the scene's box is a ball.
class ConfirmedName : public Chain {
 protected:
  void confirmTheBox() {
    test::writeSceneIndex(index_path_);
    start();
    const ObjectsConstPtr objects = objectsFor(scene_.depth_mm());
    ASSERT_TRUE(objects && labelled(*objects, "box"));
    number_ = labelled(*objects, "box")->number;
    ConfirmObject call;
    call.request.number = number_;
    call.request.category = "ball";
    ASSERT_TRUE(ros::service::call(name_ + "/confirm_object", call));
    EXPECT_TRUE(call.response.success) << call.response.message;
    EXPECT_EQ(call.response.message.substr(0, 6), "ball: ");
    EXPECT_EQ(call.response.message.find("kept"), std::string::npos) << "there is no file";
  }
  const Object* theBox(const Objects& objects) const {
    for (const Object& object : objects.objects)
      if (object.number == number_) return &object;
    return nullptr;
  }

  TableScene scene_;
  std::uint32_t number_ = 0;
};

TEST_F(ConfirmedName, IsThatOfTheNextFramesWhileItRests) {
  confirmTheBox();
  Listener<Objects> listener(node_, "objects");
  for (int frame = 0; frame < 5; ++frame) {
    const ObjectsConstPtr objects = answerTo(scene_.depth_mm(), listener);
    ASSERT_TRUE(objects && theBox(*objects));
    const Object* const box = theBox(*objects);
    EXPECT_EQ(box->label, "ball");
    EXPECT_EQ(box->score, 1);
    EXPECT_EQ(box->synset, 2778669u);
    EXPECT_EQ(box->model, "ball-3");
    ASSERT_EQ(box->alternatives.size(), 2u);
    EXPECT_EQ(box->alternatives[1].label, "box");
    EXPECT_EQ(box->alternatives[1].score, 0);
    EXPECT_GT(box->distance, box->alternatives[1].distance);
    EXPECT_EQ(box->model_pose.status, ModelPose::OFF + 0);
    EXPECT_EQ(std::count_if(objects->objects.begin(), objects->objects.end(),
                            [](const Object& object) { return object.label == "ball"; }),
              2)
        << "the ball is one by its code";
  }
}

TEST_F(ConfirmedName, GoesWhenItIsMoved) {
  confirmTheBox();
  scene_.boxes[0].centre_m.x() -= 0.03;
  Listener<Objects> listener(node_, "objects");
  EXPECT_TRUE(test::eventually(5, [&] {
    const ObjectsConstPtr objects = answerTo(scene_.depth_mm(), listener);
    return objects && theBox(*objects) && theBox(*objects)->label == "box";
  }));
}

}  // namespace
}  // namespace voxid
