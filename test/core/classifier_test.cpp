// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/core/classifier.h"

#include <gtest/gtest.h>

#include "core/index_fixture.h"

namespace voxid {
namespace {

// Categories 0 to 12 of five models with two views each: view v belongs to category v / 10. The curve is 20 x bin.
class ClassifierTest : public testing::Test {
 protected:
  ClassifierTest() {
    IndexContent content = test::randomContent(13, 5, 2, 1);
    for (int bin = 0; bin < format::Calibration::kBins; ++bin) {
      content.calibration.score_permille[bin] = static_cast<std::uint16_t>(100 + 20 * bin);
    }
    index_ = test::writtenIndex(folder_, content);
  }

  Answer classify(std::vector<Neighbour> views, std::vector<Neighbour> categories, ClassifyMethod method,
                  int min_score_permille = 0) {
    const Nearest nearest{{views.data(), views.size()}, {categories.data(), categories.size()}, 130};
    return voxid::classify(*index_, nearest, method, min_score_permille);
  }

  test::Folder folder_;
  std::shared_ptr<const Index> index_;
};

// The nearest view is of category 2, six behind it of three models of category 5.
const std::vector<Neighbour> kViews{{20, 1000}, {50, 1010}, {51, 1020}, {52, 1030}, {30, 1040}, {53, 1050},
                                    {54, 1060}, {55, 1070}, {32, 1080}, {70, 1090}, {21, 1100}};
const std::vector<Neighbour> kCategories{{20, 1000}, {50, 1010}, {30, 1040}, {70, 1090}, {80, 1600}, {90, 2000}};

TEST_F(ClassifierTest, OneNnTakesTheNearestAndRanksByDistance) {
  const Answer answer = classify(kViews, kCategories, ClassifyMethod::OneNn);
  ASSERT_EQ(answer.count, 6);
  const std::uint32_t order[] = {2, 5, 3, 7, 8, 9};
  for (int i = 0; i < 6; ++i) {
    EXPECT_EQ(answer.alternatives[i].category, order[i]);
    EXPECT_EQ(answer.alternatives[i].view, kCategories[i].view);
    EXPECT_EQ(answer.alternatives[i].distance, kCategories[i].distance);
  }
  EXPECT_EQ(answer.margin_permille, 9u);  // 10 / 1010
  EXPECT_EQ(answer.score_permille, 100);
  EXPECT_TRUE(answer.known);
}

TEST_F(ClassifierTest, VoteGoesToTheHeaviest) {
  const Answer answer = classify(kViews, kCategories, ClassifyMethod::Vote);
  ASSERT_EQ(answer.count, 6);
  EXPECT_EQ(answer.alternatives[0].category, 5u);
  EXPECT_EQ(answer.alternatives[0].view, 50u);
  EXPECT_EQ(answer.alternatives[0].distance, 1010u);
  EXPECT_EQ(answer.alternatives[1].category, 3u);  // exp(-.18) + exp(-.36) = 1.53 against 1 of category 2
  EXPECT_EQ(answer.alternatives[2].category, 2u);
  EXPECT_EQ(answer.alternatives[3].category, 7u);
  EXPECT_EQ(answer.alternatives[4].category, 8u);
  EXPECT_EQ(answer.score_permille, 100) << "a vote against the nearest has no margin";
}

TEST_F(ClassifierTest, EachModelVotesOnceWithItsNearestView) {
  const auto first = [&](const std::vector<Neighbour>& views) {
    return classify(views, {views[0], views[1]}, ClassifyMethod::Vote).alternatives[0].category;
  };
  EXPECT_EQ(first({{10, 100}, {20, 101}, {21, 101}, {21, 102}}), 1u) << "two views of one model: exp(-.045) = 0.96";
  EXPECT_EQ(first({{10, 100}, {20, 101}, {22, 112}}), 2u) << "two models: 0.96 + exp(-.54) = 1.54";
  EXPECT_EQ(first({{10, 100}, {20, 150}, {22, 150}, {24, 150}, {26, 150}, {28, 150}}), 1u) << "5 exp(-2.25) = 0.53";
}

TEST_F(ClassifierTest, ScoreFollowsTheCurveAtTheMargin) {
  const auto scoreAt = [&](std::uint32_t d1, std::uint32_t d2) {
    return classify({{0, d1}}, {{0, d1}, {10, d2}}, ClassifyMethod::OneNn).score_permille;
  };
  EXPECT_EQ(scoreAt(1000, 1000), 100);
  EXPECT_EQ(scoreAt(969, 1000), 100);  // 32 x 0.031 = 0.992
  EXPECT_EQ(scoreAt(968, 1000), 120);  // 32 x 0.032 = 1.024
  EXPECT_EQ(scoreAt(500, 1000), 420);
  EXPECT_EQ(scoreAt(0, 1000), 720);
  EXPECT_EQ(scoreAt(0, 0), 100);
  EXPECT_EQ(classify({{0, 5}}, {{0, 5}}, ClassifyMethod::OneNn).score_permille, 720);
  EXPECT_EQ(classify({{0, 5}}, {{0, 5}}, ClassifyMethod::OneNn).margin_permille, 1000u);
}

TEST_F(ClassifierTest, ScoresFallAndStayBelow1000InAll) {
  test::Random random(3);
  for (int round = 0; round < 2000; ++round) {
    std::vector<Neighbour> categories, views;
    std::uint32_t distance = static_cast<std::uint32_t>(random.below(3000));
    for (int i = 0; i < 13; ++i) {
      categories.push_back({static_cast<std::uint32_t>((i * 5 + round) % 13 * 10), distance});
      distance += static_cast<std::uint32_t>(random.below(random.below(2) ? 10 : 900));
    }
    for (const Neighbour c : categories) views.push_back(c);
    const auto method = round % 2 ? ClassifyMethod::Vote : ClassifyMethod::OneNn;
    const Answer answer = classify(views, categories, method);
    ASSERT_EQ(answer.count, Answer::kMaxAlternatives);
    int sum = 0, before = 1000;
    for (const Alternative& alternative : answer.alternatives) {
      ASSERT_LE(alternative.score_permille, before) << round;
      before = alternative.score_permille;
      sum += before;
    }
    ASSERT_LE(sum, 1000);
    ASSERT_EQ(answer.alternatives[0].score_permille, answer.score_permille);
  }
}

TEST_F(ClassifierTest, EqualWeightsAreOrderedByDistanceThenCategory) {
  const Answer answer = classify({{30, 7}, {10, 7}, {20, 7}}, {{10, 7}, {20, 7}, {30, 7}}, ClassifyMethod::Vote);
  EXPECT_EQ(answer.alternatives[0].category, 1u);
  EXPECT_EQ(answer.alternatives[1].category, 2u);
  EXPECT_EQ(answer.alternatives[2].category, 3u);
}

TEST_F(ClassifierTest, ExactMatchOutweighsEverything) {
  const Answer answer = classify({{40, 0}, {50, 1}, {51, 1}}, {{40, 0}, {50, 1}}, ClassifyMethod::Vote);
  EXPECT_EQ(answer.alternatives[0].category, 4u);
  EXPECT_EQ(answer.margin_permille, 1000u);
}

TEST_F(ClassifierTest, BelowTheWantedScoreItIsUnknownAndStillRanked) {
  EXPECT_TRUE(classify(kViews, kCategories, ClassifyMethod::OneNn, 100).known);
  const Answer answer = classify(kViews, kCategories, ClassifyMethod::OneNn, 101);
  EXPECT_FALSE(answer.known);
  EXPECT_EQ(answer.count, 6);
}

TEST_F(ClassifierTest, NothingFoundIsNoAnswer) {
  const Answer answer = classify({}, {}, ClassifyMethod::Vote);
  EXPECT_EQ(answer.count, 0);
  EXPECT_FALSE(answer.known);
}

}  // namespace
}  // namespace voxid
