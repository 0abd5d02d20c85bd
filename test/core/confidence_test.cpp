// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/core/confidence.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/index_fixture.h"
#include "voxid/core/classifier.h"

namespace voxid {
namespace {

// Four categories of three models with five views each: view v belongs to model v / 5 and to category v / 15.
class ConfidenceTest : public testing::Test {
 protected:
  ConfidenceTest() : index_(test::writtenIndex(folder_, test::randomContent(4, 3, 5, 1))) {}

  ConfidenceFeatures features(std::uint32_t category, std::uint32_t left_out = Search::kNone) const {
    const Nearest nearest{{views_.data(), views_.size()}, {categories_.data(), categories_.size()}, 60};
    return confidenceFeatures(*index_, nearest, category, left_out);
  }

  test::Folder folder_;
  std::shared_ptr<const Index> index_;
  std::vector<Neighbour> views_{{0, 1023}, {1, 1023}, {5, 1023}, {15, 1023}, {30, 2047}};
  std::vector<Neighbour> categories_{{0, 1023}, {15, 1023}, {30, 2047}, {45, 3071}};
};

TEST_F(ConfidenceTest, FeaturesAreWhatTheHeaderSays) {
  const ConfidenceFeatures first = features(0);
  EXPECT_EQ(first[0], 2560);  // log2 of 1,024
  EXPECT_EQ(first[1], 0);
  EXPECT_EQ(first[2], 256);        // 2,048 over 1,024
  EXPECT_EQ(first[3], 256 + 128);  // four categories only: 3,072 over 1,024, linear between 2 and 4
  const double far = std::exp(-3.0 * (2047.0 / 1023 - 1));
  EXPECT_NEAR(first[4], 1024 * 3 / (4 + far), 1.5);
  EXPECT_EQ(first[5], first[4]);  // five views only
  EXPECT_EQ(first[6], 128);       // views 0 and 1 are of one model
  EXPECT_EQ(first[7], 256 + 128);
  EXPECT_EQ(first[8], 128 * 384 / 256);
}

TEST_F(ConfidenceTest, TheMarginIsAgainstTheNearestOfAnotherCategory) {
  categories_[0].distance = views_[0].distance = 511;
  EXPECT_EQ(features(0)[1], 256);
  EXPECT_EQ(features(1)[1], -256) << "the vote went against the nearest";
  categories_[1].distance = 0xffffffff;
  EXPECT_EQ(features(0)[1], 1024) << "four octaves at most";
  categories_.resize(1);
  EXPECT_EQ(features(0)[1], 1024) << "no other category";
  EXPECT_EQ(features(0)[2], 1024);
}

TEST_F(ConfidenceTest, TheModelThatIsLeftOutDoesNotCount) {
  EXPECT_EQ(features(0, 1)[7], 256);
  EXPECT_EQ(features(0, 4)[7], 384) << "of another category";
}

TEST(ConfidencePermille, IsTheLogisticFunction) {
  format::Confidence confidence{};
  confidence.weights[0] = format::Confidence::kUnit / 256;
  for (int x = -3000; x <= 3000; x += 7) {
    ConfidenceFeatures features{};
    features[0] = x;
    const double expected = 1000 / (1 + std::exp(-std::clamp(x / 256.0, -7.0, 7.0)));
    EXPECT_NEAR(confidencePermille(confidence, features), expected, 1.01) << x;
  }
}

TEST(ConfidencePermille, IsNeverSureAndHoldsTheLargestWeights) {
  format::Confidence confidence{};
  ConfidenceFeatures features;
  features.fill(1 << 18);
  std::fill(std::begin(confidence.weights), std::end(confidence.weights), INT32_MAX);
  EXPECT_EQ(confidencePermille(confidence, features), 999);
  std::fill(std::begin(confidence.weights), std::end(confidence.weights), INT32_MIN);
  EXPECT_EQ(confidencePermille(confidence, features), 1);
}

TEST(Confidence, IsWrittenReadAndTakesThePlaceOfTheCurve) {
  test::Folder folder;
  IndexContent content = test::randomContent(4, 3, 5, 1);
  content.confidence = format::Confidence{10, 7, 0, {}, {}};
  const auto index = test::writtenIndex(folder, content);
  EXPECT_EQ(index->header().minor, 2);
  EXPECT_TRUE(index->verify().ok()) << index->verify().sentence;
  ASSERT_NE(index->confidence(), nullptr);
  EXPECT_EQ(index->confidence()->right, 7u);
  const Neighbour only{0, 5};
  EXPECT_EQ(classify(*index, {{&only, 1}, {&only, 1}, 1}, ClassifyMethod::Vote, 0).score_permille, 500);
  EXPECT_EQ(readContent(*index).value.confidence->samples, 10u);
}

TEST(Confidence, OfNoSamplesIsNotWritten) {
  test::Folder folder;
  IndexContent content = test::randomContent(4, 3, 5, 1);
  for (const auto& wrong : {format::Confidence{0, 0, 0, {}, {}}, format::Confidence{3, 4, 0, {}, {}}}) {
    content.confidence = wrong;
    EXPECT_EQ(writeIndex(content, folder.file("x.vxi")).kind, Status::Kind::CannotDo);
  }
}

}  // namespace
}  // namespace voxid
