// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/core/index.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include "core/index_fixture.h"

namespace voxid {
namespace {

using test::Folder;

TEST(Index, HoldsWhatWasWritten) {
  Folder folder;
  IndexContent content = test::randomContent(3, 2, 4, 1);
  const ModelRecord& written = content.models[0];  // c100/m0, the first in sorted order too
  const auto index = test::writtenIndex(folder, content);
  ASSERT_NE(index, nullptr);
  EXPECT_TRUE(index->verify().ok());
  EXPECT_EQ(index->categories().size, 3u);
  EXPECT_EQ(index->models().size, 6u);
  EXPECT_EQ(index->viewCount(), 24u);
  EXPECT_EQ(index->directions().size, 4u);
  EXPECT_EQ(index->descriptorParams().pairs, 10000u);
  EXPECT_EQ(index->descriptorParams().seed, 1u);
  EXPECT_EQ(index->bytes(), test::readBytes(index->path()).size());
  EXPECT_EQ(index->categoryName(0), "c100");
  EXPECT_EQ(index->categoryName(2), "c102");
  EXPECT_EQ(index->categories()[1].synset, 1001u);
  EXPECT_EQ(index->modelName(0), "m0");
  EXPECT_EQ(index->string(index->models()[0].licence), "CC0");
  EXPECT_EQ(index->string(index->models()[0].origin), "");
  EXPECT_EQ(index->view(2).points, 502u);
  EXPECT_EQ(index->view(2).extents[1], 2);
  EXPECT_EQ(std::vector<std::uint8_t>(index->code(2), index->code(3)), written.views[2].code);
  EXPECT_EQ(index->calibration().score_permille[5], builtInCalibration({}).score_permille[5]);
}

TEST(Index, InMemoryOfItsOwnOutlivesAFileThatIsCut) {
  Folder folder;
  const std::string path = test::writtenIndex(folder, test::randomContent(3, 2, 4, 1))->path();
  const std::string before = test::readBytes(path);
  const auto index = Index::open(path, before.size());
  ASSERT_TRUE(index.ok()) << index.status.sentence;
  std::filesystem::resize_file(path, 0);  // a mapped one is gone, and with it the process that looks
  const Span<const std::uint8_t> held = index.value->file();
  EXPECT_EQ(std::string(held.begin(), held.end()), before);
  EXPECT_TRUE(index.value->verify().ok());
}

TEST(Index, NamesOfUnknownNumbersAreEmpty) {
  Folder folder;
  const auto index = test::writtenIndex(folder, test::randomContent(1, 1, 1, 1));
  EXPECT_EQ(index->categoryName(1), "");
  EXPECT_EQ(index->modelName(0xffffffff), "");
  EXPECT_EQ(index->string(0xffffffff), "");
  EXPECT_TRUE(index->bucket(0xffffffff).empty());
}

TEST(Index, BucketsHoldEveryViewUnderItsKey) {
  Folder folder;
  const auto index = test::writtenIndex(folder, test::randomContent(10, 3, 8, 2));
  std::set<std::uint32_t> views;
  for (std::uint32_t i = 0; i < index->keys().size; ++i) {
    for (const std::uint32_t view : index->bucket(i)) {
      EXPECT_EQ(keyOf(index->code(view)), index->keys()[i]);
      EXPECT_TRUE(views.insert(view).second);
    }
  }
  EXPECT_EQ(views.size(), index->viewCount());
  EXPECT_LT(index->keys().size, index->viewCount()) << "some keys should be shared";
}

TEST(Index, ParametersNameTheDescriptor) {
  const format::Parameters p = parametersOf(Profile{{123, 4}, nullptr});
  EXPECT_STREQ(p.profile, "paper");
  EXPECT_EQ(p.revision, kDescriptorRevision);
  EXPECT_EQ(p.pairs, 123u);
  EXPECT_EQ(p.seed, 4u);
  EXPECT_EQ(p.code_bytes, 416u);
}

}  // namespace
}  // namespace voxid
