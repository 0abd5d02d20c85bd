// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/library/allowed_categories.h"

#include <gtest/gtest.h>

#include <fstream>

#include "core/index_fixture.h"

namespace voxid {
namespace {

class AllowedCategoriesTest : public testing::Test {
 protected:
  /// cfg/sizes.yaml: a bed is large, a die 1 to 4 cm, a mug 7 to 16 cm; of a thing it says nothing.
  std::shared_ptr<const Index> index() {
    IndexContent content = test::randomContent(4, 1, 2, 5);
    const char* const names[] = {"bed", "die", "mug", "thing"};
    for (std::size_t i = 0; i < 4; ++i) content.models[i].category = names[i];
    return test::writtenIndex(folder_, content);
  }
  std::string write(const std::string& text) {
    const std::string path = folder_.file("list.txt");
    std::ofstream(path) << text;
    return path;
  }

  test::Folder folder_;
};

TEST_F(AllowedCategoriesTest, AFileNamesThem) {
  const auto allowed = readAllowedCategories(write("mug \r\n\nunheard_of\nbed"), *index());
  ASSERT_TRUE(allowed.ok());
  EXPECT_EQ(allowed.value, (AllowedCategories{1, 0, 1, 0}));
}

TEST_F(AllowedCategoriesTest, AFileOfNoneIsRefused) {
  EXPECT_NE(readAllowedCategories(write("unheard_of\n"), *index()).status.sentence.find("list.txt"), std::string::npos);
  EXPECT_FALSE(readAllowedCategories(folder_.file("missing.txt"), *index()).ok());
}

TEST_F(AllowedCategoriesTest, SizeLeavesOutWhatCannotBeSoLong) {
  const SizeTable sizes(*index());
  AllowedCategories fit;
  sizes.find(30, {}, &fit);
  EXPECT_EQ(fit, (AllowedCategories{0, 1, 0, 1}));
  sizes.find(100, {}, &fit);
  EXPECT_EQ(fit, (AllowedCategories{0, 0, 1, 1}));
  sizes.find(900, {}, &fit);
  EXPECT_EQ(fit, (AllowedCategories{1, 0, 0, 1}));
}

TEST_F(AllowedCategoriesTest, SizeSpeaksOnlyOfThoseListedAndNotIfNoneFits) {
  const SizeTable sizes(*index());
  AllowedCategories fit;
  sizes.find(100, {1, 1, 1, 0}, &fit);
  EXPECT_EQ(fit, (AllowedCategories{0, 0, 1, 0}));
  sizes.find(100, {1, 1, 0, 0}, &fit);
  EXPECT_EQ(fit, (AllowedCategories{1, 1, 0, 0})) << "neither fits: size is no help";
}

}  // namespace
}  // namespace voxid
