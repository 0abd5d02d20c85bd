// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/core/sketch.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "core/index_fixture.h"
#include "voxid/core/classifier.h"

namespace voxid {
namespace {

using Code = std::vector<std::uint8_t>;
using Neighbours = std::vector<std::pair<std::uint32_t, std::uint32_t>>;  // distance, view

constexpr int kCategories = 16, kModels = 8, kViews = 8;  // kSketchedViews in all
constexpr std::array<std::uint8_t, kCategories> kEveryThird{1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1};

Neighbours listOf(Span<const Neighbour> found) {
  Neighbours list;
  for (const Neighbour n : found) list.emplace_back(n.distance, n.view);
  return list;
}

Code codeOf(test::Random& random, int most) {
  Code code(kDescriptorBytes);
  for (std::uint8_t& bin : code) bin = static_cast<std::uint8_t>(random.below(most + 1));
  return code;
}

std::uint32_t boundOf(const Code& query, const Code& view) {
  std::array<std::uint8_t, kSketchBytes> sketch;
  sketchOf(view.data(), sketch.data());
  std::uint16_t bound = 0;
  lowerBounds(sketchQueryOf(query.data()), sketch.data(), 1, &bound);
  return bound;
}

TEST(Sketch, IsTheSumOfEightBinsInStepsOfThree) {
  Code code(kDescriptorBytes);
  for (int i = 0; i < 8; ++i) code[static_cast<std::size_t>(8 + i)] = static_cast<std::uint8_t>(i + 1);  // 36
  code[415] = 5;
  for (std::size_t i = 16; i < 24; ++i) code[i] = 255;  // 2040
  std::array<std::uint8_t, kSketchBytes> sketch;
  sketchOf(code.data(), sketch.data());
  EXPECT_EQ(sketch[0], 0);
  EXPECT_EQ(sketch[1], 12);
  EXPECT_EQ(sketch[2], 255);
  EXPECT_EQ(sketch[51], 1);
}

// One group differs, by every sum that eight bins can have.
TEST(Sketch, NoBoundIsAboveTheDistanceForAnyTwoSums) {
  const auto withSum = [](int sum) {
    Code code(kDescriptorBytes);
    for (std::size_t i = 0; i < 8; ++i, sum -= std::min(sum, 255))
      code[i] = static_cast<std::uint8_t>(std::min(sum, 255));
    return code;
  };
  constexpr int kStride = 7, kMostSum = 8 * 255;
  for (int a = 0; a <= kMostSum; a += kStride) {
    const Code query = withSum(a);
    for (int b = 0; b <= kMostSum; ++b) {
      const int difference = std::abs(a - b), bound = static_cast<int>(boundOf(query, withSum(b)));
      ASSERT_LE(bound, difference) << a << " " << b;
      if (std::max(a, b) < 765) {
        ASSERT_GE(bound, difference - 4) << a << " " << b;
      }
    }
  }
}

TEST(Sketch, NoBoundIsAboveTheDistanceOfRandomCodes) {
  test::Random random(3);
  for (int i = 0; i < 2000; ++i) {
    const Code a = codeOf(random, i % 256), b = codeOf(random, i * 7 % 256);
    ASSERT_LE(boundOf(a, b), l1(a.data(), b.data()));
  }
}

TEST(Sketch, ManyRowsAreBoundAsEachAlone) {
  test::Random random(4);
  const Code query = codeOf(random, 90);
  std::vector<std::uint8_t> sketches(33 * kSketchBytes);
  for (std::uint8_t& byte : sketches) byte = static_cast<std::uint8_t>(random.below(256));
  std::vector<std::uint16_t> bounds(33);
  const SketchQuery prepared = sketchQueryOf(query.data());
  lowerBounds(prepared, sketches.data(), 33, bounds.data());
  for (std::size_t i = 0; i < 33; ++i) {
    std::uint16_t bound = 0;
    lowerBounds(prepared, &sketches[i * kSketchBytes], 1, &bound);
    EXPECT_EQ(bounds[i], bound);
  }
}

class SketchSearchTest : public testing::Test {
 protected:
  static IndexContent content() { return test::randomContent(kCategories, kModels, kViews, 21); }

  // The views as they are, of the categories the nearest.
  static void expectExact(const std::shared_ptr<const Index>& index, const std::vector<Code>& queries) {
    const auto exact = makeExactSearch(index), sketch = makeSearch(index, {});
    for (std::size_t i = 0; i < queries.size(); ++i) {
      const std::uint32_t left_out =
          i % 2 == 0 ? Search::kNone : static_cast<std::uint32_t>(i % (kCategories * kModels));
      const Span<const std::uint8_t> some{kEveryThird.data(), i % 3 == 0 ? kEveryThird.size() : 0};
      const SearchScope scope{some, left_out};
      const Nearest &a = exact->find(queries[i].data(), scope), &b = sketch->find(queries[i].data(), scope);
      ASSERT_EQ(listOf(a.views), listOf(b.views)) << i;
      ASSERT_GE(b.categories.size, std::min<std::size_t>(a.categories.size, 10)) << i;
      Neighbours nearest = listOf(a.categories);
      nearest.resize(b.categories.size);
      ASSERT_EQ(nearest, listOf(b.categories)) << i;
      const Answer x = classify(*index, a, ClassifyMethod::Vote, 0), y = classify(*index, b, ClassifyMethod::Vote, 0);
      ASSERT_EQ(x.score_permille, y.score_permille);
      ASSERT_EQ(x.count, y.count);
      for (int k = 0; k < x.count; ++k) ASSERT_EQ(x.alternatives[k].view, y.alternatives[k].view);
    }
  }

  std::vector<Code> queries(int most) {
    std::vector<Code> codes{Code(kDescriptorBytes, 0), Code(kDescriptorBytes, 255)};
    for (int i = 0; i < 30; ++i) codes.push_back(test::randomCode(random_));
    for (int i = 0; i < 30; ++i) codes.push_back(codeOf(random_, most));
    return codes;
  }

  test::Folder folder_;
  test::Random random_{22};
};

TEST_F(SketchSearchTest, EqualsExhaustiveSearch) { expectExact(test::writtenIndex(folder_, content()), queries(20)); }

// Bytes at their limit, where a sketch says least.
TEST_F(SketchSearchTest, EqualsExhaustiveSearchAmongFullBins) {
  IndexContent full = content();
  for (ModelRecord& model : full.models) {
    for (ViewRecord& view : model.views) view.code = codeOf(random_, 255);
  }
  expectExact(test::writtenIndex(folder_, full), queries(255));
}

// Bins change places inside their groups: every bound is zero, and only comparing tells.
TEST_F(SketchSearchTest, EqualsExhaustiveSearchWhereSketchesAreAllAlike) {
  IndexContent alike = content();
  for (ModelRecord& model : alike.models) {
    for (ViewRecord& view : model.views) {
      view.code.assign(kDescriptorBytes, 0);
      for (int group = 0; group < 52; ++group) view.code[static_cast<std::size_t>(group * 8 + random_.below(8))] = 40;
    }
  }
  std::vector<Code> asked = queries(20);
  asked.push_back(alike.models[5].views[2].code);
  expectExact(test::writtenIndex(folder_, alike), asked);
}

// All views but a few are one and the same: the lower numbers win, and categories come only with the whole.
TEST_F(SketchSearchTest, EqualsExhaustiveSearchAmongTies) {
  IndexContent ties = content();
  for (ModelRecord& model : ties.models) {
    for (ViewRecord& view : model.views) view.code = Code(kDescriptorBytes, model.category == "c107" ? 3 : 9);
  }
  expectExact(test::writtenIndex(folder_, ties), queries(12));
}

TEST_F(SketchSearchTest, ComparesOnlyAFewWhereSketchesTell) {
  IndexContent apart = content();
  for (std::size_t i = 0; i < apart.models.size(); ++i) {
    for (ViewRecord& view : apart.models[i].views) {
      for (std::uint8_t& bin : view.code) bin = static_cast<std::uint8_t>(i + random_.below(3));
    }
  }
  const auto index = test::writtenIndex(folder_, apart);
  EXPECT_LT(makeSearch(index, {})->find(index->code(512)).scanned, 600u);
}

TEST_F(SketchSearchTest, IsWhatTheChainUsesUnlessItHasARadius) {
  const auto index = test::writtenIndex(folder_, content());
  ClassifyParams params;
  const auto exact = makeExactSearch(index), usual = makeSearch(index, searchParamsOf(params));
  params.radius_bits = 0;
  const auto key = makeSearch(index, searchParamsOf(params));
  const Code code = test::randomCode(random_);
  const Neighbours nearest = listOf(exact->find(code.data()).views);
  EXPECT_EQ(listOf(usual->find(code.data()).views), nearest);
  EXPECT_NE(listOf(key->find(code.data()).views), nearest);
}

TEST_F(SketchSearchTest, ASmallIndexHasNoSketches) {
  const auto index = test::writtenIndex(folder_, test::randomContent(3, 2, 2, 5));
  EXPECT_TRUE(sketchesOf(*index).empty());
}

TEST_F(SketchSearchTest, AnIndexOfManyViewsHasOneSketchAView) {
  const auto index = test::writtenIndex(folder_, content());
  EXPECT_EQ(index->header().minor, kMinorSketch);
  EXPECT_EQ(sketchesOf(*index).size, kSketchedViews * kSketchBytes);
  EXPECT_TRUE(index->verify().ok());
}

TEST_F(SketchSearchTest, WritingWhatWasReadGivesTheSameBytes) {
  const auto index = test::writtenIndex(folder_, content());
  const auto read = readContent(*index);
  ASSERT_TRUE(read.ok());
  const std::string again = folder_.file("again.vxi");
  ASSERT_TRUE(writeIndex(read.value, again).ok());
  EXPECT_TRUE(test::readBytes(again) == test::readBytes(index->path()));
}

}  // namespace
}  // namespace voxid
