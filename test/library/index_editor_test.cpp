// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/library/index_editor.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>

#include "core/index_fixture.h"
#include "core/projection_fixture.h"
#include "voxid/library/index_assembler.h"

namespace voxid {
namespace {

constexpr int kCategories = 1000, kViews = 255;

ModelRecord modelOf(int category, const std::string& name, test::Random& random) {
  ModelRecord model{"c" + std::to_string(1000 + category), name, "CC0", "", 0, {}};
  for (int i = 0; i < kViews; ++i) {
    std::vector<std::uint8_t> code(kCodeBytes);
    for (std::uint8_t& byte : code) byte = static_cast<std::uint8_t>(random.bits());
    model.views.push_back({static_cast<std::uint8_t>(i), 0, {1, 2, 3}, std::move(code)});
  }
  return model;
}

// A model of each of many categories.
Status writeShelf(const std::string& name, const std::string& path) {
  const Profile profile{{}, test::projectionOf(test::randomProjectionContent(7, 1))};
  IndexAssembler whole(profile, test::someDirections(kViews), path);
  test::Random random(name.size());
  for (int category = 0; category < kCategories; ++category) {
    const Status status = whole.add(modelOf(category, name, random));
    if (!status.ok()) return status;
  }
  return whole.write(path, {}, std::nullopt);
}

std::uint64_t ownBytes() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.rfind("VmData:", 0) == 0) return std::stoull(line.substr(7)) * 1024;
  }
  return 0;
}

#ifdef __SANITIZE_ADDRESS__
constexpr bool kGivesBack = false;  // its allocator keeps what was freed
#else
constexpr bool kGivesBack = true;
#endif

// 510,000 views: were they held, by some 100 bytes each, they would not fit.
TEST(MergeIndices, TakesNoMemoryByTheView) {
  test::Folder folder;
  const std::string first = folder.file("a.vxi"), second = folder.file("b.vxi"), out = folder.file("out.vxi");
  ASSERT_TRUE(writeShelf("m1", first).ok());
  ASSERT_TRUE(writeShelf("other", second).ok());
  const pid_t child = ::fork();
  if (child == 0) {
    constexpr std::uint64_t kMost = 48 << 20;
    const struct rlimit limit { ownBytes() + kMost, ownBytes() + kMost };
    if (kGivesBack) ::setrlimit(RLIMIT_DATA, &limit);
    ::_exit(mergeIndices({first, second}, out, Clash::Refuse).ok() ? 0 : 1);
  }
  int ended = -1;
  ASSERT_EQ(::waitpid(child, &ended, 0), child);
  EXPECT_EQ(ended, 0);
  const auto merged = test::openGood(out);
  ASSERT_NE(merged, nullptr);
  EXPECT_EQ(merged->viewCount(), 2u * kCategories * kViews);
  EXPECT_EQ(merged->verify().sentence, "");
}

TEST(MergeIndices, LaterModelsWinOrAreRefusedByName) {
  test::Folder folder;
  const std::string first = folder.file("a.vxi"), second = folder.file("b.vxi"), out = folder.file("out.vxi");
  IndexContent content = test::randomContent(3, 2, 2, 8);
  ASSERT_TRUE(writeIndex(content, first).ok());
  content.models.resize(1);
  content.models[0].origin = "elsewhere";
  ASSERT_TRUE(writeIndex(content, second).ok());
  const Status refused = mergeIndices({first, second}, out, Clash::Refuse);
  EXPECT_EQ(refused.kind, Status::Kind::CannotDo);
  EXPECT_EQ(refused.sentence, second + ": model c100/m0 is there already; --replace takes the new one");
  ASSERT_TRUE(mergeIndices({first, second}, out, Clash::Replace).ok());
  const auto merged = test::openGood(out);
  ASSERT_EQ(merged->models().size, 6u);
  EXPECT_EQ(merged->string(merged->models()[0].origin), "elsewhere");
  EXPECT_EQ(merged->string(merged->models()[1].origin), "");
}

}  // namespace
}  // namespace voxid
