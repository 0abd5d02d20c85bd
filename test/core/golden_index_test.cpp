// SPDX-License-Identifier: BSD-3-Clause
// The files of formats 1.2 and 1.3 in profile "default", with all their sections, and of 1.5 in "paper"; that of 1.0 is
// in index_writer_test.cpp. And a file of each profile with every section that there is, from which the fuzzer starts.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

#include "core/index_fixture.h"
#include "core/projection_fixture.h"
#include "core/surface_fixture.h"
#include "voxid/core/kept_surface.h"
#include "voxid/core/sketch.h"

namespace voxid {
namespace {

using test::readBytes;

constexpr std::uint32_t kLists = 5;

ViewRecord viewOf(int direction, int turn) {
  ViewRecord view{static_cast<std::uint8_t>(direction), 0, {0x0100, 0x8012, 65535}, {}};
  for (int i = 0; i < static_cast<int>(kCodeBytes); ++i) {
    const int numbers = (i * turn * 37 + 11 * turn) % 225;
    view.code.push_back(static_cast<std::uint8_t>(0x11 + numbers % 15 + 16 * (numbers / 15)));
  }
  return view;
}

IndexContent goldenContent() {
  IndexContent content;
  content.profile.projection = test::projectionOf(test::randomProjectionContent(kLists, 12));
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

/// VOXID_WRITE_GOLDEN=1 writes the file anew.
std::string placeOf(const std::string& golden, const std::string& other) {
  return std::getenv("VOXID_WRITE_GOLDEN") != nullptr ? golden : other;
}

// The writer makes these bytes, the reader reads them; those of "default" change with what its codes hold.
std::shared_ptr<const Index> writtenAndRead(const IndexContent& content, const std::string& golden) {
  test::Folder folder;
  const std::string path = placeOf(golden, folder.file("x.vxi"));
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

// ---- every section ---------------------------------------------------------------------------------------------

constexpr char kCompleteDefault[] = "test/data/fuzz/complete_default.vxi";
constexpr char kCompletePaper[] = "test/data/fuzz/complete_paper.vxi";

IndexContent completeDefault() {
  IndexContent content = goldenContent1_3();
  content.models.back().surface = test::keptTetrahedron();
  return content;
}

/// Without SUMS, which the writer leaves out of a file this small.
IndexContent completePaper() {
  IndexContent content = goldenContent1_5();
  content.confidence = goldenContent().confidence;
  for (ModelRecord& model : content.models) {
    if (model.category == "c100") model.sense = "mug.n.04", model.hypernyms = "entity.n.01/container.n.01/mug.n.04";
  }
  return content;
}

std::string sketchesOfAll(const Index& index) {
  std::string sketches(index.viewCount() * kSketchBytes, '\0');
  for (std::uint32_t view = 0; view < index.viewCount(); ++view)
    sketchOf(index.code(view), reinterpret_cast<std::uint8_t*>(&sketches[view * kSketchBytes]));
  return sketches;
}

void expectKept(const std::string& bytes, const std::string& kept) {
  test::Folder folder;
  test::writeBytes(placeOf(kept, folder.file("x.vxi")), bytes);
  EXPECT_TRUE(bytes == readBytes(kept)) << kept;
  EXPECT_EQ(test::openGood(kept)->verify().sentence, "");
}

TEST(CompleteIndex, IsWhatTheFuzzerStartsFrom) {
  test::Folder of_default, of_paper;
  expectKept(readBytes(test::writtenIndex(of_default, completeDefault())->path()), kCompleteDefault);
  const auto paper = test::writtenIndex(of_paper, completePaper());
  expectKept(test::withSection(readBytes(paper->path()), "SUMS", sketchesOfAll(*paper)), kCompletePaper);
}

/// A good file in which one byte at a time is another.
class Flipper {
 public:
  explicit Flipper(const std::string& good) : good_(readBytes(good)), path_(folder_.file("x.vxi")) {
    test::writeBytes(path_, good_);
    file_.open(path_, std::ios::binary | std::ios::in | std::ios::out);
  }
  std::size_t size() const { return good_.size(); }
  std::size_t find(const std::string& bytes) const { return good_.find(bytes); }

  bool isFound(std::size_t at, int flip) {
    put(at, static_cast<char>(good_[at] ^ flip));
    const auto index = Index::open(path_);
    const bool found = !index.ok() || !index.value->verify().ok();
    put(at, good_[at]);
    return found;
  }

 private:
  void put(std::size_t at, char byte) {
    file_.seekp(static_cast<std::streamoff>(at));
    file_.put(byte).flush();
  }

  test::Folder folder_;
  const std::string good_, path_;
  std::fstream file_;
};

TEST(CompleteIndex, EveryFlippedBitOfPaperIsRefusedOrFound) {
  Flipper file(kCompletePaper);
  for (std::size_t at = 0; at < file.size(); ++at) {
    for (int bit = 0; bit < 8; ++bit) ASSERT_TRUE(file.isFound(at, 1 << bit)) << "byte " << at << ", bit " << bit;
  }
}

// Of the projection's numbers, which have one sum, some.
TEST(CompleteIndex, EveryFlippedByteOfDefaultIsRefusedOrFound) {
  Flipper file(kCompleteDefault);
  constexpr std::size_t kStride = 101;
  const std::size_t numbers = file.find({std::begin(format::kProjectionMagic), std::end(format::kProjectionMagic)}) +
                              sizeof(format::Projection);
  const std::size_t last = numbers + kCodeNumbers * (kDepthBins + 8 + kLists) + sizeof(format::Calibration) - kStride;
  ASSERT_LT(last, file.size());
  for (std::size_t at = 0; at < file.size(); at += at >= numbers && at < last ? kStride : 1)
    ASSERT_TRUE(file.isFound(at, 1 << at % 8)) << "byte " << at;
}

}  // namespace
}  // namespace voxid
