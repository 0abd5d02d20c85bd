// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/library/confidence_learner.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/index_fixture.h"
#include "voxid/core/classifier.h"
#include "voxid/core/confidence.h"
#include "voxid/core/search.h"
#include "voxid/library/index_editor.h"

namespace voxid {
namespace {

/// Codes of profile "paper": those of a category are near one number each, in every second category so widely spread
/// that they lie among the others.
IndexContent partlyClear(int categories, int models, int views) {
  IndexContent content = test::randomContent(categories, models, views, 1);
  test::Random random(9);
  for (ModelRecord& model : content.models) {
    const int category = std::stoi(model.category.substr(1)) - 100;
    const int spread = category % 2 == 0 ? 6 : 120;
    for (ViewRecord& view : model.views) {
      for (auto& bin : view.code) bin = static_cast<std::uint8_t>(category * 8 + random.below(spread));
    }
  }
  return content;
}

TEST(ConfidenceLearner, SaysHowOftenTheVoteIsRight) {
  test::Folder folder;
  const auto index = test::writtenIndex(folder, partlyClear(12, 4, 10));
  const auto learnt = learnConfidence(index);
  ASSERT_TRUE(learnt);
  EXPECT_EQ(learnt->samples, 480u);
  const auto search = makeSearch(index, {});
  std::uint32_t right = 0;
  double said = 0, said_clear = 0;
  for (std::uint32_t view = 0; view < index->viewCount(); ++view) {
    const std::uint32_t model = index->modelOf(view), category = index->models()[model].category;
    const Nearest& found = search->find(index->code(view), {{}, model});
    const std::uint32_t answer = classify(*index, found, ClassifyMethod::Vote, 0).alternatives[0].category;
    const double permille = confidencePermille(*learnt, confidenceFeatures(*index, found, answer, model));
    right += answer == category;
    said += permille / 480;
    if (category % 2 == 0) said_clear += permille / 240;
  }
  EXPECT_EQ(learnt->right, right);
  EXPECT_NEAR(said, 1000.0 * right / 480, 3) << "said on average what is seen on average";
  EXPECT_GT(said_clear, said + 100) << "surer where it is more often right";
}

TEST(ConfidenceLearner, FewModelsTeachNothing) {
  test::Folder folder;
  EXPECT_FALSE(learnConfidence(test::writtenIndex(folder, partlyClear(7, 4, 20))));   // 28 models
  EXPECT_FALSE(learnConfidence(test::writtenIndex(folder, partlyClear(20, 2, 20))));  // none in a category of three
  EXPECT_FALSE(learnConfidence(test::writtenIndex(folder, partlyClear(10, 3, 6))));   // 180 views
  EXPECT_TRUE(learnConfidence(test::writtenIndex(folder, partlyClear(10, 3, 7))));
}

TEST(ConfidenceLearner, MergingAndRemovingGiveTheBytesOfTheWhole) {
  test::Folder folder;
  const IndexContent content = partlyClear(12, 4, 10);
  IndexContent whole = content, first = content, second = content;
  const auto isFirst = [](const ModelRecord& model) { return model.name == "m0" || model.category < "c105"; };
  auto& rest = first.models;
  rest.erase(std::remove_if(rest.begin(), rest.end(), [&](const auto& m) { return !isFirst(m); }), rest.end());
  second.models.erase(std::remove_if(second.models.begin(), second.models.end(), isFirst), second.models.end());
  std::vector<std::string> removed;
  for (const ModelRecord& model : second.models) removed.push_back(model.category + "/" + model.name);

  const auto written = [&](IndexContent& part, const std::string& name) {
    EXPECT_TRUE(writeIndex(part, folder.file(name)).ok());
    EXPECT_TRUE(mergeIndices({folder.path() + "/" + name}, folder.path() + "/" + name, Clash::Refuse).ok());
    return folder.path() + "/" + name;
  };
  const std::string paths[] = {written(whole, "whole"), written(first, "first"), written(second, "second")};
  const std::string merged = folder.file("merged");
  ASSERT_TRUE(mergeIndices({paths[2], paths[1]}, merged, Clash::Refuse).ok());
  EXPECT_EQ(test::readBytes(merged), test::readBytes(paths[0]));
  EXPECT_NE(test::openGood(merged)->confidence(), nullptr);
  ASSERT_TRUE(removeModels(merged, removed).ok());
  EXPECT_EQ(test::readBytes(merged), test::readBytes(paths[1]));
}

}  // namespace
}  // namespace voxid
