// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/core/coarse.h"

#include <gtest/gtest.h>

#include "core/index_fixture.h"

namespace voxid {
namespace {

constexpr char kTop[] = "entity.n.01/physical_entity.n.01/object.n.01/whole.n.02/artifact.n.01/instrumentality.n.03/";

// c100 mug, c101 cup, c102 box, c103 hammer, c104 not known.
std::shared_ptr<const Index> taught(test::Folder& folder) {
  const std::string container = std::string(kTop) + "container.n.01";
  const std::string paths[] = {container + "/vessel.n.03/drinking_vessel.n.01/mug.n.04",
                               container + "/vessel.n.03/drinking_vessel.n.01/cup.n.01", container + "/box.n.01",
                               std::string(kTop) + "implement.n.01/tool.n.01/hammer.n.02", ""};
  IndexContent content = test::randomContent(5, 1, 1, 3);
  for (ModelRecord& model : content.models) model.hypernyms = paths[model.category[3] - '0'];
  return test::writtenIndex(folder, content);
}

Answer answerOf(const std::vector<std::pair<std::uint32_t, int>>& scores) {
  Answer answer;
  for (const auto& [category, score] : scores) {
    Alternative& next = answer.alternatives[static_cast<std::size_t>(answer.count++)];
    next.category = category;
    next.score_permille = static_cast<std::uint16_t>(score);
  }
  return answer;
}

class Coarse : public testing::Test {
 protected:
  CoarseAnswer of(const std::vector<std::pair<std::uint32_t, int>>& scores, int enough = 700) const {
    return coarseAnswer(*index_, answerOf(scores), enough);
  }
  test::Folder folder_;
  std::shared_ptr<const Index> index_ = taught(folder_);
};

TEST_F(Coarse, TheIndexIsSoundAndOfFormat1_3) {
  EXPECT_EQ(index_->verify().sentence, "");
  EXPECT_EQ(index_->header().minor, 3);
  EXPECT_EQ(index_->hypernymsOf(4), "");
  EXPECT_EQ(index_->hypernymsOf(99), "");
}

TEST_F(Coarse, ACategoryThatIsSureIsItsOwnSynset) {
  const CoarseAnswer answer = of({{0, 750}, {3, 250}});
  EXPECT_EQ(answer.synset, "mug.n.04");
  EXPECT_EQ(answer.score_permille, 750);
  EXPECT_TRUE(answer.is_category);
}

TEST_F(Coarse, WhatDisagreesMeetsAtTheLowestCommonHypernym) {
  EXPECT_EQ(of({{0, 400}, {1, 400}, {3, 200}}).synset, "drinking_vessel.n.01");
  EXPECT_EQ(of({{0, 400}, {2, 350}, {3, 250}}).synset, "container.n.01");
  EXPECT_EQ(of({{3, 280}, {0, 260}, {1, 240}, {2, 220}}).synset, "container.n.01") << "against the first alternative";
  EXPECT_FALSE(of({{0, 400}, {1, 400}}).is_category);
}

TEST_F(Coarse, NothingIsSaidWhereOnlyTheTopIsShared) {
  EXPECT_EQ(of({{0, 500}, {3, 500}}).synset, "");
  EXPECT_EQ(of({{0, 600}, {4, 400}}).synset, "") << "one has no hypernyms";
  EXPECT_EQ(of({{4, 1000}}).synset, "");
  EXPECT_EQ(of({}).synset, "");
}

TEST_F(Coarse, EnoughIsMoreThanHalf) {
  EXPECT_EQ(of({{0, 501}, {3, 499}}, 0).synset, "mug.n.04");
  EXPECT_EQ(of({{0, 500}, {3, 500}}, 0).synset, "");
}

TEST_F(Coarse, ASynsetInWords) {
  EXPECT_EQ(wordsOf("drinking_vessel.n.01"), "drinking vessel");
  EXPECT_EQ(wordsOf("box"), "box");
  EXPECT_EQ(wordsOf(""), "");
}

}  // namespace
}  // namespace voxid
