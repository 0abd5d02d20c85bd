// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/core/evidence.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/index_fixture.h"

namespace voxid {
namespace {

// Four categories of one model with ten views: view v belongs to category v / 10.
class EvidenceTest : public testing::Test {
 protected:
  EvidenceTest() : index_(test::writtenIndex(folder_, test::randomContent(4, 1, 10, 1))) {}

  void see(std::vector<Neighbour> categories) {
    std::sort(categories.begin(), categories.end());
    const Nearest nearest{{categories.data(), categories.size()}, {categories.data(), categories.size()}, 40};
    evidence_.add(*index_, nearest, classify(*index_, nearest, ClassifyMethod::Vote, 0));
  }
  std::vector<std::uint32_t> order(int hold = 0) {
    const Answer answer = evidence_.answer(*index_, 0, hold);
    std::vector<std::uint32_t> categories;
    for (int i = 0; i < answer.count; ++i)
      categories.push_back(answer.alternatives[static_cast<std::size_t>(i)].category);
    return categories;
  }

  using Categories = std::vector<std::uint32_t>;
  test::Folder folder_;
  std::shared_ptr<const Index> index_;
  Evidence evidence_{4};
};

TEST_F(EvidenceTest, TheLeastSumOfDistancesIsTheAnswer) {
  see({{3, 100}, {13, 130}, {23, 140}, {33, 900}});
  EXPECT_EQ(order(), (Categories{0, 1, 2, 3}));
  see({{4, 200}, {14, 150}, {24, 500}, {34, 180}});
  EXPECT_EQ(order(), (Categories{1, 0, 2, 3}));
  const Answer answer = evidence_.answer(*index_, 0, 0);
  EXPECT_EQ(answer.alternatives[0].view, 14u) << "the view of the last frame";
  EXPECT_EQ(answer.alternatives[0].distance, 150u);
  EXPECT_EQ(answer.margin_permille, 66u);  // 20 of 300
  EXPECT_EQ(evidence_.meanDistance(), 140u);
  EXPECT_EQ(evidence_.lastDistance(), 150u);
}

TEST_F(EvidenceTest, WhatWasNotMetIsAsFarAsTheFarthest) {
  see({{0, 100}, {10, 300}});
  see({{0, 400}, {10, 450}, {20, 250}});
  EXPECT_EQ(order(), (Categories{0, 2, 1})) << "500, 300 + 250, 750; category 3 was never met";
  see({{10, 700}, {20, 800}});
  EXPECT_EQ(evidence_.lastDistance(), 800u) << "of category 0, which this frame did not meet";
}

TEST_F(EvidenceTest, TheFirstCategoryIsNoAnswerUnlessItWasMet) {
  see({{10, 100}, {20, 200}});
  EXPECT_EQ(order(), (Categories{1, 2}));
}

TEST_F(EvidenceTest, ScoresAreMeansOverTheFrames) {
  see({{0, 100}, {10, 400}});
  const int first = evidence_.answer(*index_, 0, 0).score_permille;
  see({{1, 390}, {11, 400}});
  const int mean = evidence_.answer(*index_, 0, 0).score_permille;
  Evidence second(4);
  std::swap(evidence_, second);
  see({{1, 390}, {11, 400}});
  EXPECT_NEAR(mean, (first + evidence_.answer(*index_, 0, 0).score_permille) / 2.0, 1);
  EXPECT_FALSE(evidence_.answer(*index_, 1000, 0).known);
}

TEST_F(EvidenceTest, HalfIsForgottenAfterAHalfLife) {
  for (int i = 0; i < 2; ++i) see({{0, 100}, {10, 200}});
  evidence_.forget(5000, 10000);
  evidence_.forget(5000, 10000);
  see({{0, 310}, {10, 200}});  // 2 x 100 / 2 + 310 against 2 x 200 / 2 + 200
  EXPECT_EQ(order(), (Categories{1, 0}));
  EXPECT_NEAR(evidence_.meanDistance(), 200, 2);
  evidence_.forget(1000000, 10000);
  EXPECT_TRUE(evidence_.empty());
  EXPECT_EQ(evidence_.answer(*index_, 0, 0).count, 0);
}

// Sums and their factors at the far end of the half-life's range.
TEST_F(EvidenceTest, TheLongestHalfLifeForgetsAsWell) {
  constexpr std::int64_t kHalfLife_ms = 600000, kFrame_ms = 5;
  for (int i = 0; i < 1000; ++i) see({{0, 400000}, {10, 500000}});
  for (int i = 0; i < kHalfLife_ms / kFrame_ms; ++i) evidence_.forget(kFrame_ms, kHalfLife_ms);
  for (int i = 0; i < 1000; ++i) see({{0, 100000}, {10, 500000}});
  EXPECT_EQ(order(), (Categories{0, 1}));
  EXPECT_NEAR(evidence_.meanDistance(), 200000, 2000);
}

TEST_F(EvidenceTest, HoursOfFramesSayWhatOneDoes) {
  for (int i = 0; i < 60000; ++i) {
    evidence_.forget(33, 600000);
    see({{0, 400000}, {10, 500000}});
  }
  EXPECT_EQ(order(), (Categories{0, 1}));
  EXPECT_NEAR(evidence_.meanDistance(), 400000, 40);
}

TEST_F(EvidenceTest, TheFirstIsHeldUnlessAnotherIsClearlyBetter) {
  see({{0, 100}, {10, 110}});
  EXPECT_EQ(order(16), (Categories{0, 1}));
  see({{0, 110}, {10, 95}});  // 210 against 205
  EXPECT_EQ(order(16), (Categories{0, 1}));
  see({{0, 110}, {10, 85}});  // 320 against 290
  EXPECT_EQ(order(16), (Categories{1, 0}));
}

TEST_F(EvidenceTest, AnEmptySearchAddsNothing) {
  see({});
  EXPECT_TRUE(evidence_.empty());
}

}  // namespace
}  // namespace voxid
