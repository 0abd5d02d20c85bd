// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/library/text_file.h"

#include <gtest/gtest.h>

#include "core/index_fixture.h"

namespace voxid {
namespace {

std::string firstLineOf(const std::string& text) {
  test::Folder folder;
  const std::string path = folder.file("text");
  std::ofstream(path) << text;
  std::ifstream file = openText(path);
  std::string line;
  std::getline(file, line);
  return line;
}

TEST(TextFile, TheByteOrderMarkIsNoPartOfTheText) {
  EXPECT_EQ(firstLineOf("\xEF\xBB\xBFmug\nbowl\n"), "mug");
  EXPECT_EQ(firstLineOf("mug\nbowl\n"), "mug");
  EXPECT_EQ(firstLineOf(""), "");
}

TEST(TextFile, WhatOnlyBeginsLikeOneStays) {
  EXPECT_EQ(firstLineOf("\xEF\xBD\x8D\xEF\xBD\x95\xEF\xBD\x87\n"), "\xEF\xBD\x8D\xEF\xBD\x95\xEF\xBD\x87");
  EXPECT_EQ(firstLineOf("\xEF"), "\xEF");
}

TEST(TextFile, WhatIsNotThereIsNotOpen) { EXPECT_FALSE(openText("/nowhere/text")); }

}  // namespace
}  // namespace voxid
