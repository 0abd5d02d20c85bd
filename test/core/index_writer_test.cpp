// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/library/index_writer.h"

#include <dirent.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>

#include "core/index_fixture.h"

namespace voxid {
namespace {

using test::Folder;
using test::readBytes;

int entriesIn(const std::string& folder) {
  DIR* const directory = ::opendir(folder.c_str());
  int entries = -2;  // . and ..
  while (::readdir(directory) != nullptr) ++entries;
  ::closedir(directory);
  return entries;
}

std::string bytesOf(const IndexContent& content) {
  Folder folder;
  const std::string path = folder.file("x.vxi");
  const Status status = writeIndex(content, path);
  EXPECT_TRUE(status.ok()) << status.sentence;
  return readBytes(path);
}

// The content of test/data/golden/v1.vxi, by integer formulas.
IndexContent goldenContent() {
  IndexContent content;
  content.profile.params = {5000, 7};
  content.directions = test::someDirections(4);
  for (int bin = 0; bin < format::Calibration::kBins; ++bin) {
    content.calibration.score_permille[bin] = static_cast<std::uint16_t>(20 * bin);
  }
  content.calibration.samples = 321;
  const auto view = [](int direction, int peak) {
    ViewRecord record{
        static_cast<std::uint8_t>(direction), static_cast<std::uint32_t>(1000 + peak), {9, 99, 65535}, {}};
    for (int i = 0; i < kDescriptorBytes; ++i) record.code.push_back(static_cast<std::uint8_t>((i * peak) % 251));
    return record;
  };
  content.models = {{"mug", "b", "CC0", "https://example.org/b", 3797390, {view(0, 3), view(2, 5)}},
                    {"bowl", "a", "CC-BY-4.0", "", 2881193, {view(3, 3)}},
                    {"mug", "\xc3\xa4", "CC0", "https://example.org/b", 3797390, {view(1, 7), view(2, 3)}}};
  return content;
}

// Format 1 is kept for ever: the writer makes these bytes, every reader reads them. VOXID_WRITE_GOLDEN=1 writes the
// file.
TEST(WriteIndex, GoldenFileOfVersion1) {
  const std::string path = "test/data/golden/v1.vxi";
  if (std::getenv("VOXID_WRITE_GOLDEN") != nullptr) {
    ASSERT_TRUE(writeIndex(goldenContent(), path).ok());
  }
  EXPECT_TRUE(bytesOf(goldenContent()) == readBytes(path)) << "the bytes of " << path << " changed";
  const auto index = test::openGood(path);
  ASSERT_NE(index, nullptr);
  EXPECT_TRUE(index->verify().ok());
  ASSERT_EQ(index->models().size, 3u);
  EXPECT_EQ(index->modelName(2), "\xc3\xa4");
  EXPECT_EQ(index->view(4).direction, 2);
}

TEST(WriteIndex, OrderOfModelsDoesNotMatter) {
  IndexContent content = test::randomContent(5, 4, 3, 1);
  const std::string bytes = bytesOf(content);
  std::reverse(content.models.begin(), content.models.end());
  EXPECT_TRUE(bytesOf(content) == bytes);
}

TEST(WriteIndex, WritingWhatWasReadGivesTheSameBytes) {
  Folder folder;
  const auto index = test::writtenIndex(folder, test::randomContent(7, 3, 5, 2));
  const Result<IndexContent> content = readContent(*index);
  ASSERT_TRUE(content.ok());
  EXPECT_EQ(content.value.models.size(), 21u);
  EXPECT_TRUE(bytesOf(content.value) == readBytes(index->path()));
}

IndexContent withSense(IndexContent content, const std::string& category, const std::string& sense) {
  for (ModelRecord& model : content.models) {
    if (model.category == category) model.sense = sense;
  }
  return content;
}

TEST(WriteIndex, SensesComeBackAndLeaveTheOtherSectionsAlone) {
  Folder folder;
  const std::string plain = folder.file("plain.vxi"), named = folder.file("named.vxi");
  const IndexContent content = test::randomContent(3, 2, 2, 5);
  ASSERT_TRUE(writeIndex(content, plain).ok());
  ASSERT_TRUE(writeIndex(withSense(content, "c101", "mug.n.04"), named).ok());
  const auto before = Index::open(plain).value, after = Index::open(named).value;
  ASSERT_TRUE(before && after);
  EXPECT_EQ(after->verify().sentence, "");
  EXPECT_EQ(before->header().minor, 0);
  EXPECT_EQ(after->header().minor, format::kMinorSenses);
  EXPECT_EQ(before->sections().size + 1, after->sections().size);
  EXPECT_EQ(before->senseOf(1), "");
  EXPECT_EQ(after->senseOf(0), "");
  EXPECT_EQ(after->senseOf(1), "mug.n.04");
  EXPECT_EQ(after->senseOf(99), "");
  for (std::size_t i = 0; i < before->sections().size; ++i) {
    const std::string tag(before->sections()[i].tag, 4);
    EXPECT_EQ(before->sections()[i].crc32c == after->sections()[i].crc32c, tag != "STRS") << tag;
  }
  EXPECT_EQ(bytesOf(readContent(*after).value), readBytes(named));
}

TEST(WriteIndex, ReplacesWhatIsThereAndReadersKeepTheOldFile) {
  Folder folder;
  const std::string path = folder.file("x.vxi");
  ASSERT_TRUE(writeIndex(test::randomContent(2, 1, 1, 3), path).ok());
  const auto old = test::openGood(path);
  ASSERT_TRUE(writeIndex(test::randomContent(3, 2, 2, 4), path).ok());
  EXPECT_EQ(old->models().size, 2u);
  EXPECT_TRUE(old->verify().ok());
  EXPECT_EQ(test::openGood(path)->models().size, 6u);
  EXPECT_EQ(entriesIn(folder.path()), 1);
  struct stat info {};
  ASSERT_EQ(::stat(path.c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 0400, 0400u);
}

void expectRefused(const IndexContent& content, const std::string& reason) {
  Folder folder;
  const Status status = writeIndex(content, folder.path() + "/x.vxi");
  EXPECT_EQ(status.kind, Status::Kind::CannotDo);
  EXPECT_NE(status.sentence.find(reason), std::string::npos) << status.sentence;
  EXPECT_EQ(entriesIn(folder.path()), 0);
}

template <typename Change>
IndexContent spoilt(Change change) {
  IndexContent content = test::randomContent(2, 2, 2, 5);
  change(content);
  return content;
}

TEST(WriteIndex, RefusesWhatAReaderCouldNotRelyOn) {
  expectRefused({}, "no model");
  expectRefused(spoilt([](IndexContent& c) { c.models[1].views.clear(); }), "has no view");
  expectRefused(spoilt([](IndexContent& c) { c.models.push_back(c.models[0]); }), "twice");
  expectRefused(spoilt([](IndexContent& c) { c.models[0].synset = 7; }), "synset");
  expectRefused(spoilt([](IndexContent& c) { c.models[0].sense = "mug.n.04"; }), "sense");
  expectRefused(spoilt([](IndexContent& c) { c.models[0].name.clear(); }), "empty category or name");
  expectRefused(spoilt([](IndexContent& c) { c.models[0].category.clear(); }), "empty category or name");
  expectRefused(spoilt([](IndexContent& c) { c.models[0].origin = std::string("a\0b", 3); }), "NUL");
  expectRefused(spoilt([](IndexContent& c) { c.models[0].views[1].direction = 0; }), "do not ascend");
  expectRefused(spoilt([](IndexContent& c) { c.models[0].views[1].direction = 2; }), "direction is not in the list");
  expectRefused(spoilt([](IndexContent& c) { c.models[0].views[1].code.pop_back(); }), "code of 415 bytes");
  expectRefused(spoilt([](IndexContent& c) { c.calibration.score_permille[0] = 1000; }), "calibration");
  expectRefused(spoilt([](IndexContent& c) { c.profile.params.pairs = 0; }), "pairs");
  expectRefused(spoilt([](IndexContent& c) { c.directions.resize(257); }), "256 directions");
}

TEST(WriteIndex, SaysWhyItCannotWrite) {
  Folder folder;
  const IndexContent content = test::randomContent(1, 1, 1, 6);
  const Status no_folder = writeIndex(content, folder.path() + "/none/x.vxi");
  EXPECT_EQ(no_folder.kind, Status::Kind::CannotDo);
  EXPECT_NE(no_folder.sentence.find("No such file or directory"), std::string::npos) << no_folder.sentence;
  EXPECT_EQ(writeIndex(content, folder.path()).kind, Status::Kind::CannotDo) << "a folder cannot be replaced";
}

// A limit on the file's size stands for a full disk: writing fails in the middle.
TEST(WriteIndex, AFullDiskLeavesTheOldFileAndNothingElse) {
  Folder folder;
  const std::string path = folder.file("x.vxi");
  ASSERT_TRUE(writeIndex(test::randomContent(1, 1, 1, 6), path).ok());
  const std::string old = readBytes(path);
  struct rlimit before {};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const struct rlimit small { 10000, before.rlim_max };
  std::signal(SIGXFSZ, SIG_IGN);
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  const Status full = writeIndex(test::randomContent(10, 5, 5, 7), path);
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
  EXPECT_EQ(full.kind, Status::Kind::CannotDo);
  EXPECT_NE(full.sentence.find("File too large"), std::string::npos) << full.sentence;
  EXPECT_TRUE(readBytes(path) == old);
  EXPECT_EQ(entriesIn(folder.path()), 1);
}

TEST(BuiltInCalibration, Rises) {
  const format::Calibration curve = builtInCalibration({});
  EXPECT_EQ(curve.samples, 0u);
  EXPECT_TRUE(std::is_sorted(std::begin(curve.score_permille), std::end(curve.score_permille)));
  EXPECT_GT(curve.score_permille[0], 0);
  EXPECT_LE(curve.score_permille[format::Calibration::kBins - 1], 1000);
}

}  // namespace
}  // namespace voxid
