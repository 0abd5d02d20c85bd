// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/library/model_shelf.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "geometry/solids.h"
#include "library/ply.h"

namespace voxid {
namespace {

namespace fs = std::filesystem;

class ModelShelfTest : public testing::Test {
 protected:
  ModelShelfTest() {
    for (const char* name : {"a", "b", "c"})
      test::writePly(test::corner(), folder_ / "thing" / (std::string(name) + ".ply"));
  }
  ~ModelShelfTest() override { fs::remove_all(folder_); }

  const fs::path folder_ = fs::temp_directory_path() / ("voxid_shelf_" + std::to_string(getpid()));
};

TEST_F(ModelShelfTest, AModelIsReadOnce) {
  ModelShelf shelf(folder_);
  const auto first = shelf.find("thing/a");
  ASSERT_TRUE(first.ok()) << first.status.sentence;
  EXPECT_EQ(first.value->model.surface().triangles.size(), test::corner().triangles.size());
  fs::remove(folder_ / "thing" / "a.ply");
  EXPECT_EQ(shelf.find("thing/a").value, first.value);
}

TEST_F(ModelShelfTest, BeyondItsBytesItForgetsTheOneNotAskedForLongest) {
  ModelShelf unbounded(folder_);
  ASSERT_TRUE(unbounded.find("thing/a").ok());
  const std::size_t one = unbounded.bytes();
  ModelShelf shelf(folder_, 2 * one);
  const auto a = shelf.find("thing/a").value, b = shelf.find("thing/b").value;
  EXPECT_EQ(shelf.find("thing/a").value, a);
  ASSERT_TRUE(shelf.find("thing/c").ok());
  EXPECT_EQ(shelf.bytes(), 2 * one);
  EXPECT_EQ(shelf.find("thing/a").value, a);
  EXPECT_NE(shelf.find("thing/b").value, b);  // read anew; what was handed out lives on
  EXPECT_FALSE(b->model.surface().triangles.empty());
}

TEST_F(ModelShelfTest, SaysWhyThereIsNoSurface) {
  ModelShelf shelf(folder_);
  EXPECT_NE(shelf.find("thing/d").status.sentence.find("thing/d: no mesh of this name"), std::string::npos);
  EXPECT_NE(ModelShelf("").find("thing/a").status.sentence.find("no folder of models is given"), std::string::npos);
}

}  // namespace
}  // namespace voxid
