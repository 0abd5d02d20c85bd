// SPDX-License-Identifier: BSD-3-Clause
#include "pose_board.h"

#include <gtest/gtest.h>

#include "conversions.h"

namespace voxid {
namespace {

Objects frame(double seconds, const std::vector<std::pair<std::uint32_t, double>>& numbers_and_places) {
  Objects objects;
  objects.header.stamp = ros::Time(seconds);
  for (const auto& [number, x_m] : numbers_and_places) {
    Object object;
    object.number = number;
    object.pose.pose.position = pointOf({x_m, 0, 1});
    objects.objects.push_back(object);
  }
  return objects;
}

ModelPose poseOf(const std::string& model) {
  ModelPose pose;
  pose.status = ModelPose::ALIGNED;
  pose.model = model;
  return pose;
}

ModelPose shown(PoseBoard& board, double seconds, double x_m, std::uint32_t number = 7) {
  Objects objects = frame(seconds, {{number, x_m}});
  board.show(ModelPose::WAITING, &objects);
  return objects.objects[0].model_pose;
}

TEST(PoseBoard, APoseHoldsWhileItsObjectRests) {
  PoseBoard board;
  board.put(frame(100, {{7, 0}}).objects[0], ros::Time(100), poseOf("mug-1"), 0.2f);
  EXPECT_EQ(shown(board, 101, 0.01).model, "mug-1");
  EXPECT_EQ(shown(board, 101, 0.01, 8).status, ModelPose::WAITING + 0);
  EXPECT_EQ(shown(board, 101, 0.01, 0).status, ModelPose::OFF + 0) << "no number, no memory";
  EXPECT_EQ(shown(board, 102, 0.03).status, ModelPose::WAITING + 0);
  EXPECT_EQ(shown(board, 103, 0).status, ModelPose::WAITING + 0) << "it may have been turned meanwhile";
}

TEST(PoseBoard, WhatIsNotSeenForLongIsForgotten) {
  PoseBoard board;
  board.put(frame(100, {{7, 0}}).objects[0], ros::Time(100), poseOf("mug-1"), 0.2f);
  Objects nothing = frame(109, {});
  board.show(ModelPose::WAITING, &nothing);
  EXPECT_EQ(shown(board, 109, 0).model, "mug-1");
  nothing = frame(120, {});
  board.show(ModelPose::WAITING, &nothing);
  EXPECT_EQ(shown(board, 120, 0).status, ModelPose::WAITING + 0);
}

TEST(PoseBoard, TheBestOfThreeTriesIsKept) {
  PoseBoard board;
  const Object object = frame(100, {{7, 0}}).objects[0];
  board.put(object, ros::Time(100), poseOf("first"), 0.2f);
  EXPECT_FALSE(board.next(frame(100.5, {{7, 0}}))) << "too soon";
  ASSERT_TRUE(board.next(frame(101, {{7, 0}})));
  board.put(object, ros::Time(101), poseOf("better"), 0.1f);
  board.put(object, ros::Time(102), poseOf("worse"), 0.3f);
  EXPECT_EQ(shown(board, 102, 0).model, "better");
  EXPECT_FALSE(board.next(frame(110, {{7, 0}})));
}

TEST(PoseBoard, WhatWasNeverTriedComesFirst) {
  PoseBoard board;
  board.put(frame(100, {{7, 0}}).objects[0], ros::Time(100), poseOf("mug-1"), 0.2f);
  EXPECT_EQ(board.next(frame(105, {{0, 0.5}, {7, 0}, {8, 0.3}})), std::optional<std::size_t>(2));
  EXPECT_EQ(board.next(frame(105, {{0, 0.5}, {7, 0}})), std::optional<std::size_t>(1));
  EXPECT_FALSE(board.next(frame(105, {{0, 0.5}})));
}

}  // namespace
}  // namespace voxid
