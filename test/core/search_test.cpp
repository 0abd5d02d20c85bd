// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/core/search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <set>

#include "core/index_fixture.h"

namespace voxid {
namespace {

using Code = std::vector<std::uint8_t>;
using Neighbours = std::vector<std::pair<std::uint32_t, std::uint32_t>>;  // distance, view

Neighbours listOf(Span<const Neighbour> found) {
  Neighbours list;
  for (const Neighbour n : found) list.emplace_back(n.distance, n.view);
  return list;
}

std::uint32_t slowDistance(const Code& code, const std::uint8_t* other) {
  std::uint32_t sum = 0;
  for (int i = 0; i < kDescriptorBytes; ++i) sum += static_cast<std::uint32_t>(std::abs(code[i] - other[i]));
  return sum;
}

struct Expected {
  Neighbours views, categories;
  std::uint32_t scanned;
};

// Sorts everything that `counts` lets through.
template <typename Counts>
Expected bruteForce(const Index& index, const Code& code, Counts counts) {
  Neighbours all;
  std::map<std::uint32_t, std::pair<std::uint32_t, std::uint32_t>> best;
  for (std::uint32_t view = 0; view < index.viewCount(); ++view) {
    if (!counts(view)) continue;
    const std::pair<std::uint32_t, std::uint32_t> found{slowDistance(code, index.code(view)), view};
    all.push_back(found);
    const std::uint32_t category = index.models()[index.modelOf(view)].category;
    const auto entry = best.emplace(category, found).first;
    entry->second = std::min(entry->second, found);
  }
  std::sort(all.begin(), all.end());
  Expected expected{all, {}, static_cast<std::uint32_t>(all.size())};
  if (all.size() > kNearestViews) expected.views.resize(kNearestViews);
  for (const auto& [category, found] : best) expected.categories.push_back(found);
  std::sort(expected.categories.begin(), expected.categories.end());
  return expected;
}

void expectEqual(const Nearest& found, const Expected& expected) {
  EXPECT_EQ(listOf(found.views), expected.views);
  EXPECT_EQ(listOf(found.categories), expected.categories);
  EXPECT_EQ(found.scanned, expected.scanned);
}

class SearchTest : public testing::Test {
 protected:
  std::shared_ptr<const Index> make(int categories, int models, int views) {
    return test::writtenIndex(folder_, test::randomContent(categories, models, views, 11));
  }
  Code query() { return test::randomCode(random_); }
  std::uint32_t modelOf(const Index& index, std::uint32_t view) { return index.modelOf(view); }

  test::Folder folder_;
  test::Random random_{12};
};

TEST_F(SearchTest, ExactEqualsBruteForce) {
  const auto index = make(12, 3, 9);
  const auto search = makeExactSearch(index);
  for (int i = 0; i < 50; ++i) {
    const Code code = query();
    expectEqual(search->find(code.data()), bruteForce(*index, code, [](std::uint32_t) { return true; }));
  }
}

TEST_F(SearchTest, AViewFindsItselfAndTiesGoToTheLowerNumber) {
  IndexContent content = test::randomContent(4, 2, 2, 13);
  for (ModelRecord& model : content.models) model.views[1].code = content.models[0].views[1].code;
  const auto index = test::writtenIndex(folder_, content);
  const auto search = makeExactSearch(index);
  const Nearest& found = search->find(content.models[0].views[1].code.data());
  ASSERT_EQ(found.views.size, 16u);
  for (std::uint32_t i = 0; i < 8; ++i) {
    EXPECT_EQ(found.views[i].distance, 0u);
    EXPECT_EQ(found.views[i].view, 2 * i + 1);
  }
  ASSERT_EQ(found.categories.size, 4u);
  EXPECT_EQ(found.categories[1].view, 5u);
}

TEST_F(SearchTest, LeftOutModelDoesNotCount) {
  const auto index = make(6, 1, 7);
  const auto exact = makeExactSearch(index), lsh = makeLshSearch(index, kKeyBits);
  for (std::uint32_t model = 0; model < 6; ++model) {
    const Code code(index->code(model * 7 + 3), index->code(model * 7 + 4));
    const Expected expected =
        bruteForce(*index, code, [&](std::uint32_t view) { return modelOf(*index, view) != model; });
    EXPECT_EQ(expected.categories.size(), 5u);
    expectEqual(exact->find(code.data(), {{}, model}), expected);
    expectEqual(lsh->find(code.data(), {{}, model}), expected);
  }
}

TEST_F(SearchTest, OnlyCategoriesInScopeCount) {
  const auto index = make(12, 2, 7);
  const std::vector<std::uint8_t> even{1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0}, none(12, 0);
  const auto exact = makeExactSearch(index), lsh = makeLshSearch(index, kKeyBits);
  for (const std::uint32_t left_out : {Search::kNone, 4u, 3u}) {
    const Code code = query();
    const Expected expected = bruteForce(*index, code, [&](std::uint32_t view) {
      const std::uint32_t model = modelOf(*index, view);
      return model != left_out && index->models()[model].category % 2 == 0;
    });
    const SearchScope scope{{even.data(), even.size()}, left_out};
    expectEqual(exact->find(code.data(), scope), expected);
    expectEqual(lsh->find(code.data(), scope), expected);
  }
  EXPECT_TRUE(exact->find(query().data(), {{none.data(), none.size()}}).views.empty());
  EXPECT_TRUE(lsh->find(query().data(), {{none.data(), none.size()}}).categories.empty());
}

std::size_t categoriesIn(const Expected& expected) { return expected.categories.size(); }

TEST_F(SearchTest, LshEqualsBruteForceInsideTheBall) {
  const auto index = make(40, 2, 6);
  for (const int radius : {0, 2, 4, 8, 52}) {
    const auto search = makeLshSearch(index, radius);
    for (int i = 0; i < 30; ++i) {
      const Code code = query();
      const auto inBall = [&](int bits) {
        return bruteForce(*index, code, [&](std::uint32_t view) {
          return hammingDistance(keyOf(code.data()), keyOf(index->code(view))) <= bits;
        });
      };
      int bits = radius;
      while (categoriesIn(inBall(bits)) < 5 && bits < kKeyBits) bits += 2;
      expectEqual(search->find(code.data()), inBall(bits));
    }
  }
}

TEST_F(SearchTest, LshTakesEverythingWhereFiveCategoriesAreNotToBeHad) {
  const auto index = make(3, 1, 5);
  const auto search = makeLshSearch(index, 0);
  EXPECT_EQ(search->find(query().data()).scanned, 15u);
  EXPECT_EQ(makeLshSearch(index, -7)->find(query().data()).scanned, 15u);
  EXPECT_EQ(makeLshSearch(index, 1000)->find(query().data()).scanned, 15u);
}

TEST_F(SearchTest, WholeBallEqualsExact) {
  const auto index = make(9, 2, 9);
  const auto exact = makeExactSearch(index), lsh = makeLshSearch(index, kKeyBits);
  for (int i = 0; i < 20; ++i) {
    const Code code = query();
    const Nearest &a = exact->find(code.data()), &b = lsh->find(code.data());
    EXPECT_EQ(listOf(a.views), listOf(b.views));
    EXPECT_EQ(listOf(a.categories), listOf(b.categories));
  }
}

}  // namespace
}  // namespace voxid
