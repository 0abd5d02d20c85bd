// SPDX-License-Identifier: BSD-3-Clause
#include "pose_board.h"

#include <gtest/gtest.h>

#include "conversions.h"

namespace voxid {
namespace {

constexpr double kFrame_s = 1.0 / 15;

Objects frame(double seconds, const std::vector<std::pair<std::uint32_t, double>>& numbers_and_places,
              double extent_m = 0.12) {
  Objects objects;
  objects.header.stamp = ros::Time(seconds);
  for (const auto& [number, x_m] : numbers_and_places) {
    Object object;
    object.number = number;
    object.pose.pose.position = pointOf({x_m, 0, 1});
    object.extents_m = vectorOf({extent_m, 0.08, 0.1});
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
  board.show({}, 0, &objects, &answers);
  return objects.objects[0].model_pose;
}

TEST(PoseBoard, APoseHoldsWhileItsObjectRests) {
  PoseBoard board;
  board.put(frame(100, {{7, 0}}).objects[0], ros::Time(100), aligned("mug-1", 0.2f));
  EXPECT_EQ(shown(board, 101, 0.01).model, "mug-1");
  EXPECT_EQ(shown(board, 101, 0.01, 8).status, ModelPose::WAITING + 0);
  EXPECT_EQ(shown(board, 101, 0.01, 0).status, ModelPose::OFF + 0) << "no number, no memory";
  EXPECT_EQ(shown(board, 102, 0.03).status, ModelPose::WAITING + 0);
  EXPECT_EQ(shown(board, 102.1, 0.01).model, "mug-1") << "one frame is no move";
  EXPECT_EQ(shown(board, 103, 0.03).status, ModelPose::WAITING + 0);
  EXPECT_EQ(shown(board, 103.4, 0.03).status, ModelPose::WAITING + 0);
  EXPECT_EQ(shown(board, 104, 0).status, ModelPose::WAITING + 0) << "it may have been turned meanwhile";
}

TEST(PoseBoard, WhatIsNotSeenForLongIsForgotten) {
  PoseBoard board;
  board.put(frame(100, {{7, 0}}).objects[0], ros::Time(100), aligned("mug-1", 0.2f));
  Objects nothing = frame(109, {});
  std::vector<Answer> none;
  board.show({}, 0, &nothing, &none);
  EXPECT_EQ(shown(board, 109, 0).model, "mug-1");
  nothing = frame(120, {});
  board.show({}, 0, &nothing, &none);
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

/// What is published of an object that the codes take for `by_codes`.
Answer answered(PoseBoard& board, const Objects& seen, std::uint32_t by_codes = 1, int min_score_permille = 0) {
  Objects objects = seen;
  std::vector<Answer> answers(1);
  answers[0].count = 1;
  answers[0].alternatives[0].category = by_codes;
  answers[0].score_permille = 500;
  board.show({}, min_score_permille, &objects, &answers);
  return answers[0];
}

std::uint32_t label(PoseBoard& board, const Objects& seen, std::uint32_t by_codes = 1) {
  return answered(board, seen, by_codes).alternatives[0].category;
}

TEST(PoseBoard, TheFirstNameHoldsWhileItsObjectRests) {
  PoseBoard board;
  const Object object = frame(100, {{7, 0}}).objects[0];
  board.put(object, ros::Time(100), aligned("no name", 0.5f));
  EXPECT_EQ(label(board, frame(100.5, {{7, 0}})), 1u);
  EXPECT_FALSE(board.categoryOf(object));
  board.put(object, ros::Time(101), named(4, "mug-1", 0.2f));
  board.put(object, ros::Time(102), named(5, "jug-1", 0.1f));
  EXPECT_EQ(label(board, frame(103, {{7, 0.01}})), 4u);
  EXPECT_EQ(answered(board, frame(103, {{7, 0.01}})).score_permille, 600);
  EXPECT_EQ(board.categoryOf(object), std::optional<std::uint32_t>(4));
  EXPECT_TRUE(answered(board, frame(103, {{7, 0}}), 1, 600).known);
  EXPECT_FALSE(answered(board, frame(103, {{7, 0}}), 1, 601).known);
  EXPECT_FALSE(board.categoryOf(frame(103, {{7, 0.03}}).objects[0]));
}

/// A board that knows object 7, at x = 0, as category 4.
void nameSeven(PoseBoard& board, double seconds) {
  board.put(frame(seconds, {{7, 0}}).objects[0], ros::Time(seconds), named(4, "mug-1", 0.2f));
}

TEST(PoseBoard, AMoveIsNoticedWithinHalfASecond) {
  for (const double distance_m : {0.02, 0.03, 0.2}) {
    PoseBoard board;
    nameSeven(board, 100);
    EXPECT_EQ(label(board, frame(101, {{7, 0}})), 4u);
    double seconds = 101 + kFrame_s;
    while (label(board, frame(seconds, {{7, distance_m}})) == 4u && seconds < 102) seconds += kFrame_s;
    EXPECT_LT(seconds - 101, 0.5) << distance_m;
    EXPECT_EQ(board.next(frame(seconds, {{7, distance_m}})), std::optional<std::size_t>(0)) << "it is named anew";
    EXPECT_EQ(label(board, frame(seconds + kFrame_s, {{7, 0}})), 1u) << "it may be another one";
  }
}

TEST(PoseBoard, ABoxThatLosesAPartAndFindsItAgainKeepsPoseAndName) {
  PoseBoard board;
  const auto whole = [](double seconds) { return frame(seconds, {{7, 0}}, 0.13); };
  const auto cut = [](double seconds) { return frame(seconds, {{7, 0.022}}, 0.085); };
  board.put(cut(100).objects[0], ros::Time(100), named(4, "mug-1", 0.2f));
  int shown_poses = 0;
  for (int i = 0; i < 300; ++i) {
    Objects seen = (i / 30 + i % 2) % 3 == 0 ? whole(100 + i * kFrame_s) : cut(100 + i * kFrame_s);
    ASSERT_EQ(label(board, seen), 4u) << i;
    std::vector<Answer> none;
    board.show({}, 0, &seen, &none);
    shown_poses += seen.objects[0].model_pose.status == ModelPose::ALIGNED;
  }
  EXPECT_EQ(shown_poses, 300);
}

TEST(PoseBoard, WhatIsElsewhereForAFrameKeepsItsName) {
  PoseBoard board;
  nameSeven(board, 100);
  for (int i = 0; i < 60; ++i) {
    EXPECT_EQ(label(board, frame(100 + i * kFrame_s, {{7, i % 3 == 0 ? 0.0 : 0.04}})), 4u) << i;
  }
}

TEST(PoseBoard, WhatDriftsLosesItsPoseAndKeepsItsName) {
  PoseBoard board;
  nameSeven(board, 100);
  for (int i = 0; i < 60; ++i) {  // 3 cm a second: a camera that goes round, or a push
    EXPECT_EQ(label(board, frame(100 + i * kFrame_s, {{7, i * 0.002}})), 4u) << i;
  }
  EXPECT_EQ(shown(board, 104, 0.118).status, ModelPose::WAITING + 0);
  const Objects now = frame(104, {{7, 0.118}});
  EXPECT_EQ(board.next(now), std::optional<std::size_t>(0));
  EXPECT_EQ(board.categoryOf(now.objects[0]), std::optional<std::uint32_t>(4));
  board.put(now.objects[0], ros::Time(104), named(5, "jug-1", 0.9f));
  EXPECT_EQ(shown(board, 104.1, 0.118).model, "jug-1") << "the better fit was elsewhere";
  EXPECT_EQ(label(board, frame(104.2, {{7, 0.118}})), 4u);
}

Answer answerThatIs(std::uint32_t category) {
  Answer answer = named(category, "", 1).name;
  answer.score_permille = 1000;
  return answer;
}

TEST(PoseBoard, WhatSomebodySaysHoldsAgainstCodesAndModelsUntilItIsMoved) {
  PoseBoard board;
  EXPECT_TRUE(board.empty());
  const Object object = frame(100, {{7, 0}}).objects[0];
  board.confirm(object, ros::Time(100), answerThatIs(9));
  EXPECT_FALSE(board.empty());
  EXPECT_EQ(label(board, frame(100, {{7, 0}})), 9u) << "at once";
  board.put(object, ros::Time(101), named(4, "mug-1", 0.2f));
  EXPECT_EQ(label(board, frame(101, {{7, 0}})), 9u);
  EXPECT_EQ(board.categoryOf(object), std::optional<std::uint32_t>(9)) << "further tries look for it alone";
  label(board, frame(102, {{7, 0.03}}));
  EXPECT_EQ(label(board, frame(102.3, {{7, 0.03}})), 1u);
}

TEST(PoseBoard, APoseIsKeptIfItsNameIsConfirmed) {
  PoseBoard board;
  nameSeven(board, 100);
  const Object object = frame(100, {{7, 0}}).objects[0];
  board.confirm(object, ros::Time(101), answerThatIs(4));
  EXPECT_EQ(shown(board, 101, 0).model, "mug-1");
  EXPECT_EQ(answered(board, frame(101, {{7, 0}})).score_permille, 1000);
  board.confirm(object, ros::Time(102), answerThatIs(5));
  EXPECT_EQ(shown(board, 102, 0).status, ModelPose::WAITING + 0);
  EXPECT_EQ(board.next(frame(102, {{7, 0}})), std::optional<std::size_t>(0)) << "it is aligned anew";
}

TEST(PoseBoard, WhatIsConfirmedInAnotherPlaceIsNamedThere) {
  PoseBoard board;
  nameSeven(board, 100);
  board.confirm(frame(101, {{7, 0.03}}).objects[0], ros::Time(101), answerThatIs(4));
  for (const double seconds : {101.1, 101.5, 103.0}) EXPECT_EQ(label(board, frame(seconds, {{7, 0.03}})), 4u);
  EXPECT_EQ(shown(board, 103, 0.03).status, ModelPose::WAITING + 0);
}

TEST(PoseBoard, WhatWasAlignedBeforeItMovedIsNotKept) {
  PoseBoard board;
  label(board, frame(100, {{7, 0}}));
  board.put(frame(100, {{7, 0.1}}).objects[0], ros::Time(100), named(4, "mug-1", 0.2f));
  EXPECT_EQ(label(board, frame(100.1, {{7, 0}})), 1u);
}

TEST(PoseBoard, ALabelThatWaitsForItsNameChangesNoMoreAfterTheFirstSecond) {
  PoseBoard board;
  int changes = 0;
  std::uint32_t last = 0;
  for (int i = 0; i < 150; ++i) {
    const double seconds = 100 + i * kFrame_s;
    const std::uint32_t by_codes = 1 + static_cast<std::uint32_t>(i / 10 % 3);
    const std::uint32_t now = label(board, frame(seconds, {{7, 0}}), by_codes);
    const bool settled = seconds > 101;
    EXPECT_TRUE(settled || now == by_codes) << "in the first second the codes say";
    changes += settled && now != last;
    last = now;
    if (i == 75) nameSeven(board, seconds);
  }
  EXPECT_EQ(last, 4u);
  EXPECT_EQ(changes, 1);
}

TEST(PoseBoard, ALabelThatWaitsForNothingIsThatOfTheCodes) {
  PoseBoard board;
  for (int i = 0; i < 3; ++i)  // no name was found, in any try
    board.put(frame(100 + i, {{7, 0}}).objects[0], ros::Time(100 + i), aligned("no name", 0.5f));
  EXPECT_EQ(label(board, frame(103, {{7, 0}}), 1), 1u);
  EXPECT_EQ(label(board, frame(105, {{7, 0}}), 2), 2u);
  PoseBoard other;
  for (int i = 0; i < 30; ++i) {
    Objects seen = frame(100 + i * kFrame_s, {{7, 0}});
    std::vector<Answer> answers(1);
    answers[0].count = 1;
    answers[0].alternatives[0].category = static_cast<std::uint32_t>(i);
    other.show({ModelPose::NOT_SELECTED, false}, 0, &seen, &answers);
    EXPECT_EQ(answers[0].alternatives[0].category, static_cast<std::uint32_t>(i));
    EXPECT_EQ(seen.objects[0].model_pose.status, ModelPose::NOT_SELECTED + 0);
  }
}

}  // namespace
}  // namespace voxid
