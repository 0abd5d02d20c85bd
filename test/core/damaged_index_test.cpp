// SPDX-License-Identifier: BSD-3-Clause
// A damaged file is refused at opening or found by verify, and never believed in between.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <cstring>
#include <functional>

#include "core/index_fixture.h"
#include "voxid/core/classifier.h"
#include "voxid/core/crc32c.h"
#include "voxid/core/search.h"

namespace voxid {
namespace {

using test::Folder;
using test::readBytes;
using test::writeBytes;

constexpr char kGolden[] = "test/data/golden/v1.vxi";

// Bytes of a good file, with a pen.
class Draft {
 public:
  Draft() : bytes_(readBytes(kGolden)) { EXPECT_GT(bytes_.size(), 1000u); }

  format::Header& header() { return *reinterpret_cast<format::Header*>(bytes_.data()); }
  format::Section& section(const char* tag) {
    auto* const first = reinterpret_cast<format::Section*>(bytes_.data() + sizeof(format::Header));
    return *std::find_if(first, first + header().sections,
                         [tag](const format::Section& s) { return std::memcmp(s.tag, tag, 4) == 0; });
  }
  template <typename T>
  T* in(const char* tag) {
    return reinterpret_cast<T*>(bytes_.data() + section(tag).offset);
  }
  // Sums as the writer would make them, so that only the content is wrong.
  void sumSections() {
    for (std::uint32_t i = 0; i < header().sections; ++i) {
      auto& s = reinterpret_cast<format::Section*>(bytes_.data() + sizeof(format::Header))[i];
      s.crc32c = crc32c(bytes_.data() + s.offset, s.length);
    }
    header().descriptor_crc32c = crc32c(in<char>("PARM"), sizeof(format::Parameters));
    sumHeader();
  }
  void sumHeader() {
    header().crc32c = 0;
    header().crc32c = crc32c(bytes_.data(), sizeof(format::Header) + header().sections * sizeof(format::Section));
  }
  std::string& bytes() { return bytes_; }

 private:
  std::string bytes_;
};

Status opened(Folder& folder, const std::string& bytes) {
  const std::string path = folder.file("x.vxi");
  writeBytes(path, bytes);
  return Index::open(path).status;
}

void expectRefused(const std::string& bytes, Status::Kind kind, const std::string& reason) {
  Folder folder;
  const Status status = opened(folder, bytes);
  EXPECT_EQ(status.kind, kind) << status.sentence;
  EXPECT_NE(status.sentence.find(reason), std::string::npos) << status.sentence;
  EXPECT_NE(status.sentence.find("x.vxi"), std::string::npos) << status.sentence;
}

// Looks at everything that a search and an answer read; a sanitizer would complain of a read outside.
void useIt(const std::shared_ptr<const Index>& index) {
  const std::vector<std::uint8_t> code(kDescriptorBytes, 9);
  for (const auto& search : {makeExactSearch(index), makeLshSearch(index, 4), makeLshSearch(index, kKeyBits)}) {
    const Nearest& nearest = search->find(code.data());
    for (const ClassifyMethod method : {ClassifyMethod::OneNn, ClassifyMethod::Vote}) {
      const Answer answer = classify(*index, nearest, method, 0);
      EXPECT_LE(answer.score_permille, 1000);
      for (int i = 0; i < answer.count; ++i) {
        EXPECT_LT(answer.alternatives[i].category, index->categories().size);
        EXPECT_LT(answer.alternatives[i].view, index->viewCount());
        index->categoryName(answer.alternatives[i].category);
        index->modelName(index->view(answer.alternatives[i].view).model);
      }
    }
  }
  for (const format::Model& model : index->models()) index->string(model.name), index->string(model.origin);
  (void)readContent(*index);
}

// Sums are right, so that opening believes it: using it must be harmless, and verify must find it.
void expectFoundByVerify(Draft draft, const std::string& what) {
  draft.sumSections();
  Folder folder;
  const std::string path = folder.file("x.vxi");
  writeBytes(path, draft.bytes());
  const auto index = Index::open(path);
  ASSERT_TRUE(index.ok()) << index.status.sentence;
  useIt(index.value);
  const Status status = index.value->verify();
  EXPECT_EQ(status.kind, Status::Kind::Damaged);
  EXPECT_NE(status.sentence.find(what), std::string::npos) << status.sentence;
}

TEST(DamagedIndex, TheGoodOneIsGood) {
  Draft draft;
  const std::string bytes = draft.bytes();
  draft.sumSections();
  EXPECT_TRUE(draft.bytes() == bytes) << "the test's sums are the writer's";
  const auto index = test::openGood(kGolden);
  ASSERT_NE(index, nullptr);
  useIt(index);
  EXPECT_TRUE(index->verify().ok());
}

TEST(DamagedIndex, MissingEmptyOrNoFile) {
  Folder folder;
  const Status missing = Index::open(folder.path() + "/none.vxi").status;
  EXPECT_EQ(missing.kind, Status::Kind::CannotDo);
  EXPECT_NE(missing.sentence.find("No such file"), std::string::npos) << missing.sentence;
  EXPECT_EQ(Index::open(folder.path()).status.kind, Status::Kind::CannotDo);
  const std::string pipe = folder.file("pipe.vxi");
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_NE(Index::open(pipe).status.sentence.find("not a regular file"), std::string::npos);
  expectRefused("", Status::Kind::Damaged, "is empty");
  expectRefused("no index at all, but a text that is longer than a header of 64 bytes.......", Status::Kind::Damaged,
                "does not begin like a voxid index");
}

TEST(DamagedIndex, TruncatedAtAnyByteIsRefused) {
  Folder folder;
  const std::string path = folder.file("x.vxi");
  const std::string bytes = readBytes(kGolden);
  writeBytes(path, bytes);
  for (std::size_t length = bytes.size(); length-- > 0;) {
    ASSERT_EQ(::truncate(path.c_str(), static_cast<off_t>(length)), 0);
    ASSERT_EQ(Index::open(path).status.kind, Status::Kind::Damaged) << length;
  }
  writeBytes(path, bytes + std::string(64, '\0'));
  EXPECT_EQ(Index::open(path).status.kind, Status::Kind::Damaged) << "longer is wrong as well";
}

TEST(DamagedIndex, AnyFlippedByteIsRefusedOrFound) {
  Folder folder;
  const std::string path = folder.file("x.vxi");
  const std::string good = readBytes(kGolden);
  writeBytes(path, good);
  std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
  const auto put = [&](std::size_t at, char byte) {
    file.seekp(static_cast<std::streamoff>(at));
    file.put(byte).flush();
  };
  for (std::size_t at = 0; at < good.size(); ++at) {
    for (const int flip : {0x01, 0xff}) {
      put(at, static_cast<char>(good[at] ^ flip));
      const auto index = Index::open(path);
      if (index.ok()) useIt(index.value);
      ASSERT_FALSE(index.ok() && index.value->verify().ok()) << "byte " << at << " xor " << flip;
    }
    put(at, good[at]);
  }
}

TEST(DamagedIndex, OtherVersionsAndParametersCannotBeRead) {
  Draft other_major;
  other_major.header().major = 2;
  other_major.sumHeader();
  expectRefused(other_major.bytes(), Status::Kind::CannotDo, "version 2");
  Draft revision, profile, pairs;
  revision.in<format::Parameters>("PARM")->revision = 9;
  revision.sumSections();
  expectRefused(revision.bytes(), Status::Kind::CannotDo, "revision 9");
  std::memcpy(profile.in<format::Parameters>("PARM")->profile, "0123456789abcdef", 16);
  profile.sumSections();
  expectRefused(profile.bytes(), Status::Kind::CannotDo, "\"0123456789abcdef\"");
  pairs.in<format::Parameters>("PARM")->pairs = 0;
  pairs.sumSections();
  expectRefused(pairs.bytes(), Status::Kind::CannotDo, "0 pairs");
}

TEST(DamagedIndex, HigherMinorWithAnUnknownSectionIsRead) {
  Draft draft;
  draft.header().minor = 99;
  draft.bytes() = test::withSection(draft.bytes(), "NEW ", std::string(64, 'x'));
  Folder folder;
  const std::string path = folder.file("x.vxi");
  writeBytes(path, draft.bytes());
  const auto index = Index::open(path);
  ASSERT_TRUE(index.ok()) << index.status.sentence;
  EXPECT_TRUE(index.value->verify().ok());
  draft.bytes().back() = 'y';
  writeBytes(path, draft.bytes());
  EXPECT_FALSE(Index::open(path).value->verify().ok());
}

void expectRefusedTable(const std::function<void(Draft&)>& change, const std::string& reason) {
  Draft draft;
  change(draft);
  draft.sumHeader();
  expectRefused(draft.bytes(), Status::Kind::Damaged, reason);
}

TEST(DamagedIndex, RangesThatLieAreRefusedAtOpening) {
  constexpr std::uint64_t kHuge = 0xffffffffffffffc0;
  expectRefusedTable([](Draft& d) { d.section("CODE").offset += 64; }, "leaves its place");
  expectRefusedTable([](Draft& d) { d.section("CODE").offset = kHuge; }, "leaves its place");
  expectRefusedTable([](Draft& d) { d.section("CODE").length = kHuge; }, "leaves its place");
  expectRefusedTable([](Draft& d) { d.section("CALB").length -= 64; }, "does not end the file");
  expectRefusedTable([](Draft& d) { std::memcpy(d.section("CODE").tag, "VIEW", 4); }, "twice");
  expectRefusedTable([](Draft& d) { std::memcpy(d.section("CODE").tag, "C0DE", 4); }, "CODE is missing");
  expectRefusedTable([](Draft& d) { std::memcpy(d.section("PARM").tag, "P4RM", 4); }, "PARM is missing");
  expectRefusedTable([](Draft& d) { ++d.header().views; }, "VIEW has the wrong length");
  expectRefusedTable([](Draft& d) { d.header().models = 0xffffffff; }, "MODL has the wrong length");
  expectRefusedTable([](Draft& d) { d.header().buckets = 0xffffffff; }, "KEYS has the wrong length");
  expectRefusedTable([](Draft& d) { d.section("DIRS").length -= 1; }, "DIRS is no whole number");
  expectRefusedTable([](Draft& d) { d.section("STRS").length -= 1; }, "STRS does not begin and end");
  expectRefusedTable([](Draft& d) { d.header().header_bytes = 128; }, "section table does not fit");
}

void expectFound(const std::function<void(Draft&)>& change, const std::string& what) {
  Draft draft;
  change(draft);
  expectFoundByVerify(draft, what);
}

TEST(DamagedIndex, ReferencesThatLieAreHarmlessAndFound) {
  constexpr std::uint32_t kFar = 0xffffffff;
  expectFound([](Draft& d) { d.in<format::Category>("CATS")[1].name = kFar; }, "names do not ascend at category 1");
  expectFound([](Draft& d) { d.in<format::Category>("CATS")[1].models = kFar; }, "do not cover the models");
  expectFound([](Draft& d) { d.in<format::Category>("CATS")[1].first_model = 0; }, "wrong models in category 1");
  expectFound([](Draft& d) { d.in<format::Model>("MODL")[1].category = kFar; }, "wrong order at model 1");
  expectFound([](Draft& d) { d.in<format::Model>("MODL")[1].name = kFar; }, "wrong order at model 1");
  expectFound([](Draft& d) { d.in<format::Model>("MODL")[1].licence = kFar; }, "wrong text in model 1");
  expectFound([](Draft& d) { d.in<format::Model>("MODL")[1].first_view = kFar; }, "wrong views in model 1");
  expectFound([](Draft& d) { d.in<format::Model>("MODL")[2].views = kFar; }, "do not cover the views");
  expectFound([](Draft& d) { d.in<format::Model>("MODL")[1].zero[7] = 1; }, "padding is not zero in model 1");
  expectFound([](Draft& d) { d.in<format::View>("VIEW")[1].model = kFar; }, "in view 1");
  expectFound([](Draft& d) { d.in<format::View>("VIEW")[1].direction = 4; }, "in view 1");
  expectFound([](Draft& d) { d.in<format::View>("VIEW")[1].zero = 1; }, "padding is not zero in view 1");
  expectFound([](Draft& d) { d.in<format::Direction>("DIRS")[3].zero[0] = 1; }, "padding is not zero in direction 3");
  expectFound([](Draft& d) { d.in<std::uint8_t>("CODE")[0] = 255; }, "wrong view in bucket");
  expectFound([](Draft& d) { d.in<Key>("KEYS")[1] = ~Key{0}; }, "keys do not ascend");
  expectFound([](Draft& d) { d.in<std::uint32_t>("BKTV")[0] = kFar; }, "wrong view in bucket 0");
  expectFound([](Draft& d) { d.in<std::uint32_t>("BKTO")[1] = kFar; }, "nothing in bucket 0");
  expectFound([](Draft& d) { d.in<format::Calibration>("CALB")->score_permille[31] = 1001; }, "calibration");
  expectFound([](Draft& d) { d.in<format::Calibration>("CALB")->score_permille[3] = 0xffff; }, "calibration");
  expectFound([](Draft& d) { d.in<format::Calibration>("CALB")->zero[59] = 1; }, "calibration's padding");
  expectFound([](Draft& d) { d.header().zero[11] = 1; }, "header's padding");
  expectFound([](Draft& d) { d.section("VIEW").zero[0] = 1; }, "table entry VIEW");
  expectFound([](Draft& d) { d.bytes()[d.section("MODL").offset - 1] = 1; }, "padding before section MODL");
  expectFound(
      [](Draft& d) { d.bytes()[d.section("CATS").offset - 1] = 0, d.bytes()[d.section("STRS").offset - 1] = 1; },
      "padding before section STRS");
}

}  // namespace
}  // namespace voxid
