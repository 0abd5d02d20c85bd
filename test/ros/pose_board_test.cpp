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

AlignedObject aligned(const std::string& model, float misfit) {
  AlignedObject found;
  found.pose.status = ModelPose::ALIGNED;
  found.pose.model = model;
  found.misfit = misfit;
  return found;
}

/// Named, with a chance of 0.6.
AlignedObject named(std::uint32_t category, const std::string& model, float misfit) {
  AlignedObject found = aligned(model, misfit);
  found.name.count = 1;
  found.name.alternatives[0].category = category;
  found.name.score_permille = 600;
  return found;
}

ModelPose shown(PoseBoard& board, double seconds, double x_m, std::uint32_t number = 7) {
  Objects objects = frame(seconds, {{number, x_m}});
  std::vector<Answer> answers(1);
  board.show(ModelPose::WAITING, 0, &objects, &answers);
  return objects.objects[0].model_pose;
}

TEST(PoseBoard, APoseHoldsWhileItsObjectRests) {
  PoseBoard board;
  board.put(frame(100, {{7, 0}}).objects[0], ros::Time(100), aligned("mug-1", 0.2f));
  EXPECT_EQ(shown(board, 101, 0.01).model, "mug-1");
  EXPECT_EQ(shown(board, 101, 0.01, 8).status, ModelPose::WAITING + 0);
  EXPECT_EQ(shown(board, 101, 0.01, 0).status, ModelPose::OFF + 0) << "no number, no memory";
  EXPECT_EQ(shown(board, 102, 0.03).status, ModelPose::WAITING + 0);
  EXPECT_EQ(shown(board, 103, 0).status, ModelPose::WAITING + 0) << "it may have been turned meanwhile";
}

TEST(PoseBoard, WhatIsNotSeenForLongIsForgotten) {
  PoseBoard board;
  board.put(frame(100, {{7, 0}}).objects[0], ros::Time(100), aligned("mug-1", 0.2f));
  Objects nothing = frame(109, {});
  std::vector<Answer> none;
  board.show(ModelPose::WAITING, 0, &nothing, &none);
  EXPECT_EQ(shown(board, 109, 0).model, "mug-1");
  nothing = frame(120, {});
  board.show(ModelPose::WAITING, 0, &nothing, &none);
  EXPECT_EQ(shown(board, 120, 0).status, ModelPose::WAITING + 0);
}

TEST(PoseBoard, TheBestOfThreeTriesIsKept) {
  PoseBoard board;
  const Object object = frame(100, {{7, 0}}).objects[0];
  board.put(object, ros::Time(100), aligned("first", 0.2f));
  EXPECT_FALSE(board.next(frame(100.5, {{7, 0}}))) << "too soon";
  ASSERT_TRUE(board.next(frame(101, {{7, 0}})));
  board.put(object, ros::Time(101), aligned("better", 0.1f));
  board.put(object, ros::Time(102), aligned("worse", 0.3f));
  EXPECT_EQ(shown(board, 102, 0).model, "better");
  EXPECT_FALSE(board.next(frame(110, {{7, 0}})));
}

TEST(PoseBoard, WhatWasNeverTriedComesFirst) {
  PoseBoard board;
  board.put(frame(100, {{7, 0}}).objects[0], ros::Time(100), aligned("mug-1", 0.2f));
  EXPECT_EQ(board.next(frame(105, {{0, 0.5}, {7, 0}, {8, 0.3}})), std::optional<std::size_t>(2));
  EXPECT_EQ(board.next(frame(105, {{0, 0.5}, {7, 0}})), std::optional<std::size_t>(1));
  EXPECT_FALSE(board.next(frame(105, {{0, 0.5}})));
}

/// What is published of an object that the codes take for category 1.
Answer answered(PoseBoard& board, double seconds, double x_m, int min_score_permille = 0) {
  Objects objects = frame(seconds, {{7, x_m}});
  std::vector<Answer> answers(1);
  answers[0].alternatives[0].category = 1;
  board.show(ModelPose::WAITING, min_score_permille, &objects, &answers);
  return answers[0];
}

TEST(PoseBoard, TheFirstNameHoldsWhileItsObjectRests) {
  PoseBoard board;
  const Object object = frame(100, {{7, 0}}).objects[0];
  board.put(object, ros::Time(100), aligned("no name", 0.5f));
  EXPECT_EQ(answered(board, 100.5, 0).alternatives[0].category, 1u);
  EXPECT_FALSE(board.categoryOf(object));
  board.put(object, ros::Time(101), named(4, "mug-1", 0.2f));
  board.put(object, ros::Time(102), named(5, "jug-1", 0.1f));
  EXPECT_EQ(answered(board, 103, 0.01).alternatives[0].category, 4u);
  EXPECT_EQ(answered(board, 103, 0.01).score_permille, 600);
  EXPECT_EQ(board.categoryOf(object), std::optional<std::uint32_t>(4));
  EXPECT_TRUE(answered(board, 103, 0, 600).known);
  EXPECT_FALSE(answered(board, 103, 0, 601).known);
  EXPECT_FALSE(board.categoryOf(frame(103, {{7, 0.03}}).objects[0]));
  EXPECT_EQ(answered(board, 104, 0.03).alternatives[0].category, 1u);
  EXPECT_EQ(answered(board, 105, 0).alternatives[0].category, 1u) << "it may be another one";
}

}  // namespace
}  // namespace voxid
