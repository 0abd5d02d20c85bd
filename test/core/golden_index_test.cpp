// SPDX-License-Identifier: BSD-3-Clause
// The files of formats 1.2 and 1.3 in profile "default", with all their sections, and of 1.5 in "paper". That of 1.0 is
// in index_writer_test.cpp.
#include <gtest/gtest.h>

#include <cstdlib>

#include "core/index_fixture.h"
#include "core/projection_fixture.h"
#include "core/surface_fixture.h"
#include "voxid/core/kept_surface.h"

namespace voxid {
namespace {

using test::readBytes;

constexpr std::uint32_t kBytes = 32, kLists = 5;

ViewRecord viewOf(int direction, int turn) {
  ViewRecord view{static_cast<std::uint8_t>(direction), 0, {0x0100, 0x8012, 65535}, {}};
  for (int i = 0; i < static_cast<int>(kBytes); ++i)
    view.code.push_back(static_cast<std::uint8_t>((i * turn * 37 + 11 * turn) % 127 - 63));
  return view;
}

IndexContent goldenContent() {
  IndexContent content;
  content.profile.projection = test::projectionOf(test::randomProjectionContent(kBytes, kLists, 12));
  content.directions = test::someDirections(4);
  content.calibration.samples = 250;
  for (int bin = 0; bin < format::Calibration::kBins; ++bin)
    content.calibration.score_permille[bin] = static_cast<std::uint16_t>(100 + 20 * bin);
  content.confidence = format::Confidence{240, 120, -500000, {1, -2, 3, -4, 5, -6, 7, -8, 9}, {}};
  content.models = {{"mug", "b", "CC0", "https://example.org/b", 3797390, {viewOf(0, 3), viewOf(2, 5)}, "mug.n.04"},
                    {"bowl", "a", "CC-BY-4.0", "", 2881193, {viewOf(3, 2)}, "bowl.n.03"},
                    {"thing", "c", "", "", 0, {viewOf(1, 9), viewOf(3, 4)}, ""},
                    {"mug", "\xc3\xa4", "CC0", "https://example.org/b", 3797390, {viewOf(1, 7)}, "mug.n.04"}};
  return content;
}

IndexContent goldenContent1_3() {
  IndexContent content = goldenContent();
  for (ModelRecord& model : content.models) {
    if (!model.sense.empty()) model.hypernyms = "entity.n.01/container.n.01/" + model.sense;
  }
  return content;
}

/// A model keeps its surface, the one before and the one after it do not.
IndexContent goldenContent1_5() {
  IndexContent content = test::randomContent(2, 2, 2, 5);
  content.calibration = goldenContent().calibration;
  for (ModelRecord& model : content.models) {
    if (model.category == "c100" && model.name == "m1") model.surface = test::keptTetrahedron();
  }
  return content;
}

// Kept for ever: the writer makes these bytes, every reader reads them. VOXID_WRITE_GOLDEN=1 writes the file.
std::shared_ptr<const Index> writtenAndRead(const IndexContent& content, const std::string& golden) {
  test::Folder folder;
  const std::string path = std::getenv("VOXID_WRITE_GOLDEN") != nullptr ? golden : folder.file("x.vxi");
  EXPECT_TRUE(writeIndex(content, path).ok());
  EXPECT_TRUE(readBytes(path) == readBytes(golden)) << "the bytes of " << golden << " changed";
  const auto index = test::openGood(golden);
  EXPECT_EQ(index->verify().sentence, "");
  return index;
}

TEST(GoldenIndex, Version1_2IsWrittenAndRead) {
  const auto index = writtenAndRead(goldenContent(), "test/data/golden/v1_2.vxi");
  EXPECT_EQ(index->header().minor, 2);
  EXPECT_EQ(index->modelName(2), "\xc3\xa4");
  EXPECT_EQ(index->senseOf(1), "mug.n.04");
  EXPECT_EQ(index->senseOf(2), "");
  ASSERT_NE(index->confidence(), nullptr);
  EXPECT_EQ(index->confidence()->weights[8], 9);
  EXPECT_EQ(index->calibration().score_permille[31], 720);
  EXPECT_EQ(index->view(3).direction, 1);
  EXPECT_EQ(index->view(3).extents[1], 0x8080) << "its high byte, of 255";
}

TEST(GoldenIndex, Version1_3IsWrittenAndRead) {
  const auto index = writtenAndRead(goldenContent1_3(), "test/data/golden/v1_3.vxi");
  EXPECT_EQ(index->header().minor, 3);
  EXPECT_EQ(index->hypernymsOf(1), "entity.n.01/container.n.01/mug.n.04");
  EXPECT_EQ(index->hypernymsOf(2), "");
  EXPECT_EQ(index->senseOf(1), "mug.n.04");
}

TEST(GoldenIndex, Version1_5IsWrittenAndRead) {
  const auto index = writtenAndRead(goldenContent1_5(), "test/data/golden/v1_5.vxi");
  EXPECT_EQ(index->header().minor, 5);
  EXPECT_TRUE(index->surface(0).empty());
  EXPECT_TRUE(index->surface(2).empty());
  const auto kept = KeptSurface::of(index->surface(1));
  ASSERT_TRUE(kept);
  EXPECT_EQ(kept->vertex(1), (std::array<std::int16_t, 3>{18918, -18918, -18918}));
  EXPECT_EQ(kept->header().folds[2], 0);
}

/// Some bytes between `sparse` and `sparse_end`, which have one sum, and every byte elsewhere.
void expectEachFlipFound(const std::string& golden, std::size_t sparse, std::size_t sparse_end) {
  test::Folder folder;
  const std::string good = readBytes(golden), path = folder.file("x.vxi");
  constexpr std::size_t kStride = 101;
  for (std::size_t at = 0; at<good.size(); at += at> sparse && at + kStride < sparse_end ? kStride : 1) {
    std::string bad = good;
    bad[at] = static_cast<char>(bad[at] ^ 0x10);
    test::writeBytes(path, bad);
    const auto index = Index::open(path);
    ASSERT_FALSE(index.ok() && index.value->verify().ok()) << golden << ", byte " << at;
  }
}

TEST(GoldenIndex, AnyFlippedByteIsRefusedOrFound) {
  for (const char* const golden : {"test/data/golden/v1_2.vxi", "test/data/golden/v1_3.vxi"}) {
    const std::size_t projection = readBytes(golden).find(std::string(format::kProjectionMagic, 8));
    ASSERT_NE(projection, std::string::npos);
    expectEachFlipFound(golden, projection + 64, projection + 64 + kBytes * (kDepthBins + 8 + kLists) + 128);
  }
  expectEachFlipFound("test/data/golden/v1_5.vxi", 0, 0);
}

}  // namespace
}  // namespace voxid
