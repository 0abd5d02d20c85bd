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

TEST_F(AllowedCategoriesTest, AFewConfirmedSizesWidenARangeAndEnoughMakeIt) {
  ConfirmedSizes confirmed;
  const auto fits = [&](double longest_mm) {
    AllowedCategories fit;
    SizeTable(*index(), confirmed).find(longest_mm, {}, &fit);
    return fit;
  };
  confirmed.add("mug", 200);
  confirmed.add("bed", 400);
  confirmed.add("unheard_of", 100);
  EXPECT_EQ(fits(75), (AllowedCategories{0, 0, 1, 1})) << "as reviewed";
  EXPECT_EQ(fits(249), (AllowedCategories{0, 0, 1, 1})) << "a quarter more than 200";
  EXPECT_EQ(fits(251), (AllowedCategories{0, 0, 0, 1}));
  EXPECT_EQ(fits(301), (AllowedCategories{1, 0, 0, 1})) << "a quarter less than 400";
  for (const int longest_mm : {100, 120, 110, 100}) confirmed.add("mug", longest_mm);
  EXPECT_EQ(fits(74), (AllowedCategories{0, 0, 0, 1})) << "five: 75 to 250";
  EXPECT_EQ(fits(249), (AllowedCategories{0, 0, 1, 1}));
  for (int i = 0; i < 5; ++i) confirmed.add("thing", 100);
  EXPECT_EQ(fits(126), (AllowedCategories{0, 0, 1, 0})) << "nothing was known of it before";
}

TEST_F(AllowedCategoriesTest, ConfirmedSizesAreKeptInAFile) {
  const std::string path = folder_.file("sizes.yaml");
  ConfirmedSizes confirmed = ConfirmedSizes::read(path).value;
  EXPECT_TRUE(confirmed.longest_mm().empty()) << "it is not there yet";
  confirmed.add("mug", 112);
  confirmed.add("a: b", 30);
  confirmed.add("mug", 104);
  ASSERT_TRUE(confirmed.write(path).ok());
  const auto read = ConfirmedSizes::read(path);
  ASSERT_TRUE(read.ok()) << read.status.sentence;
  EXPECT_EQ(read.value.longest_mm(), confirmed.longest_mm());
  for (int i = 0; i < 200; ++i) confirmed.add("mug", 500 + i);
  EXPECT_EQ(confirmed.longest_mm().at("mug").size(), ConfirmedSizes::kMostEach);
  EXPECT_EQ(confirmed.longest_mm().at("mug").back(), 699);
  EXPECT_FALSE(confirmed.write(folder_.file("nowhere/sizes.yaml")).ok());
}

TEST_F(AllowedCategoriesTest, ADamagedFileOfSizesIsRefused) {
  for (const char* const text : {"mug: [112, x]", "mug: 112", "mug: [-3]", "mug: [1", "- 3", "mug"}) {
    const auto read = ConfirmedSizes::read(write(text));
    EXPECT_NE(read.status.sentence.find("list.txt: no file of confirmed sizes"), std::string::npos) << text;
  }
  EXPECT_TRUE(ConfirmedSizes::read(write("")).ok());
}

}  // namespace
}  // namespace voxid
