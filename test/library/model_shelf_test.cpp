// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/library/model_shelf.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "core/index_fixture.h"
#include "geometry/solids.h"
#include "library/ply.h"
#include "voxid/library/model_surface.h"

namespace voxid {
namespace {

namespace fs = std::filesystem;

constexpr std::uint32_t kA = 0, kB = 1, kC = 2, kMissing = 3;

class ModelShelfTest : public testing::Test {
 protected:
  ModelShelfTest() {
    for (const char* name : {"a", "b", "c"})
      test::writePly(test::corner(), folder_ / "thing" / (std::string(name) + ".ply"));
  }
  ~ModelShelfTest() override { fs::remove_all(folder_); }

  /// Of thing/a to thing/d; the folder has no d. `kept`: the surface of a.
  std::shared_ptr<const Index> index(const std::vector<std::uint8_t>& kept = {}) {
    IndexContent content = test::randomContent(1, 4, 1, 1);
    for (ModelRecord& model : content.models) {
      model.category = "thing";
      model.name = std::string(1, static_cast<char>('a' + model.name[1] - '0'));
      if (model.name == "a") model.surface = kept;
    }
    return test::writtenIndex(files_, content);
  }

  test::Folder files_;
  const fs::path folder_ = fs::temp_directory_path() / ("voxid_shelf_" + std::to_string(getpid()));
};

TEST_F(ModelShelfTest, AModelIsReadOnce) {
  ModelShelf shelf(index(), folder_);
  const auto first = shelf.find(kA);
  ASSERT_TRUE(first.ok()) << first.status.sentence;
  EXPECT_EQ(first.value->model.surface().triangles.size(), test::corner().triangles.size());
  fs::remove(folder_ / "thing" / "a.ply");
  EXPECT_EQ(shelf.find(kA).value, first.value);
}

TEST_F(ModelShelfTest, BeyondItsBytesItForgetsTheOneNotAskedForLongest) {
  ModelShelf unbounded(index(), folder_);
  ASSERT_TRUE(unbounded.find(kA).ok());
  const std::size_t one = unbounded.bytes();
  ModelShelf shelf(index(), folder_, 2 * one);
  const auto a = shelf.find(kA).value, b = shelf.find(kB).value;
  EXPECT_EQ(shelf.find(kA).value, a);
  ASSERT_TRUE(shelf.find(kC).ok());
  EXPECT_EQ(shelf.bytes(), 2 * one);
  EXPECT_EQ(shelf.find(kA).value, a);
  EXPECT_NE(shelf.find(kB).value, b);  // read anew; what was handed out lives on
  EXPECT_FALSE(b->model.surface().triangles.empty());
}

TEST_F(ModelShelfTest, SaysWhyThereIsNoSurface) {
  ModelShelf shelf(index(), folder_);
  EXPECT_NE(shelf.find(kMissing).status.sentence.find("thing/d: no mesh of this name"), std::string::npos);
  EXPECT_NE(ModelShelf(index(), "").find(kA).status.sentence.find("no folder of models is given"), std::string::npos);
}

TEST_F(ModelShelfTest, WhatTheIndexKeepsNeedsNoFolder) {
  ModelShelf shelf(index(surfaceToKeep(test::corner())), "");
  const auto kept = shelf.find(kA), read = ModelShelf(index(), folder_).find(kA);
  ASSERT_TRUE(kept.ok()) << kept.status.sentence;
  EXPECT_EQ(kept.value->symmetry().folds, read.value->symmetry().folds);
  EXPECT_EQ(kept.value->model.surface().triangles.size(), read.value->model.surface().triangles.size());
  EXPECT_NE(shelf.find(kB).status.sentence.find("thing/b: no surface is known"), std::string::npos);
}

}  // namespace
}  // namespace voxid
