// SPDX-License-Identifier: BSD-3-Clause
// Files and searches of profile "default".
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <numeric>
#include <set>

#include "core/index_fixture.h"
#include "core/projection_fixture.h"
#include "voxid/core/classifier.h"
#include "voxid/core/crc32c.h"
#include "voxid/core/refine.h"
#include "voxid/core/search.h"

namespace voxid {
namespace {

using test::Folder;
using test::readBytes;
using test::writeBytes;
using Code = std::vector<std::uint8_t>;
using Neighbours = std::vector<std::pair<std::uint32_t, std::uint32_t>>;  // distance, view

constexpr std::uint32_t kLists = 24;

/// Around few middles, so that lists differ in size and some stay empty.
Code randomDefaultCode(test::Random& random, std::size_t bytes) {
  const int middle = random.below(5) * 20 - 40;
  std::array<std::int64_t, kCodeNumbers> numbers;
  for (std::int64_t& number : numbers) number = middle + random.between(-30, 30);
  Code code(bytes);
  packCode(numbers.data(), bytes, code.data());
  return code;
}

IndexContent defaultContent(std::size_t bytes, int categories, int models, int views) {
  static const auto projection = test::projectionOf(test::randomProjectionContent(kLists, 1));
  IndexContent content = test::randomContent(categories, models, views, 2);
  content.profile = {{}, projection, bytes == kSmallCodeBytes};
  test::Random random(3);
  for (ModelRecord& model : content.models) {
    for (ViewRecord& view : model.views) view.code = randomDefaultCode(random, bytes);
  }
  return content;
}

using Numbers = std::vector<double>;

/// What distances count, written down once more.
Numbers slowNumbers(const std::uint8_t* code, std::size_t bytes) {
  Numbers numbers(kCodeNumbers);
  for (std::size_t i = 0; i < 2 * bytes; ++i) {
    const int byte = code[i % bytes], half = i < bytes ? byte % 16 : byte / 16;
    numbers[i] = 16 * (half - 8);
  }
  return numbers;
}

std::uint32_t squaresOf(const Numbers& a, const Numbers& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return static_cast<std::uint32_t>(sum);
}

std::uint32_t slowDistance(const Code& code, const std::uint8_t* other) {
  return squaresOf(slowNumbers(code.data(), code.size()), slowNumbers(other, code.size()));
}

Neighbours pairsOf(Span<const Neighbour> found) {
  Neighbours list;
  for (const Neighbour n : found) list.emplace_back(n.distance, n.view);
  return list;
}

/// Views that count, nearest first.
Neighbours sortedViews(const Index& index, const Code& code, const std::function<bool(std::uint32_t)>& counts) {
  Neighbours all;
  for (std::uint32_t view = 0; view < index.viewCount(); ++view) {
    if (counts(view)) all.emplace_back(slowDistance(code, index.code(view)), view);
  }
  std::sort(all.begin(), all.end());
  return all;
}

/// The first of each category.
Neighbours firstOfCategories(const Index& index, const Neighbours& sorted) {
  std::set<std::uint32_t> met;
  Neighbours first;
  for (const auto& found : sorted) {
    if (met.insert(index.models()[index.modelOf(found.second)].category).second) first.push_back(found);
  }
  return first;
}

Neighbours head(Neighbours list, std::size_t count) {
  list.resize(std::min(count, list.size()));
  return list;
}

const auto kAll = [](std::uint32_t) { return true; };

class DefaultIndex : public testing::TestWithParam<std::size_t> {
 protected:
  std::shared_ptr<const Index> make(int categories, int models, int views) {
    return test::writtenIndex(folder_, defaultContent(kBytes, categories, models, views));
  }
  Code randomCode() { return randomDefaultCode(random_, kBytes); }
  const std::size_t kBytes = GetParam();
  Folder folder_;
  test::Random random_{4};
};

TEST_P(DefaultIndex, HoldsWhatWasWritten) {
  IndexContent content = defaultContent(kBytes, 3, 2, 4);
  content.models[0].views.erase(content.models[0].views.begin());  // models need not have the same number
  content.models[1].views.pop_back();
  content.models[2].views[1].extents = {0, 0x8012, 65535};
  const auto index = test::writtenIndex(folder_, content);
  ASSERT_NE(index->projection(), nullptr);
  EXPECT_TRUE(index->verify().ok()) << index->verify().sentence;
  EXPECT_EQ(index->header().minor, 1);
  EXPECT_STREQ(index->parameters().profile, "default");
  EXPECT_EQ(index->parameters().code_bytes, kBytes);
  EXPECT_EQ(index->projection()->lists(), kLists);
  for (std::uint32_t model = 0; model < index->models().size; ++model) {
    const auto record = std::find_if(content.models.begin(), content.models.end(), [&](const ModelRecord& m) {
      return m.name == index->modelName(model) && m.category == index->categoryName(index->models()[model].category);
    });
    ASSERT_EQ(index->models()[model].views, record->views.size());
    for (std::uint32_t i = 0; i < record->views.size(); ++i) {
      const std::uint32_t number = index->models()[model].first_view + i;
      const format::View view = index->view(number);
      EXPECT_EQ(index->modelOf(number), model);
      EXPECT_EQ(view.model, model);
      EXPECT_EQ(view.direction, record->views[i].direction);
      for (int axis = 0; axis < 3; ++axis)
        EXPECT_EQ(view.extents[axis] >> 8, record->views[i].extents[static_cast<std::size_t>(axis)] >> 8);
      EXPECT_TRUE(std::equal(record->views[i].code.begin(), record->views[i].code.end(), index->code(number)));
    }
  }
}

TEST_P(DefaultIndex, WritingWhatWasReadGivesTheSameBytes) {
  const auto index = make(4, 2, 3);
  const Result<IndexContent> content = readContent(*index);
  ASSERT_TRUE(content.ok());
  const std::string again = folder_.file("again.vxi");
  ASSERT_TRUE(writeIndex(content.value, again).ok());
  EXPECT_TRUE(readBytes(again) == readBytes(index->path()));
}

TEST_P(DefaultIndex, AViewCostsItsCodeAndEightBytes) {
  const auto small = make(2, 2, 5);
  const std::uint64_t bytes = small->bytes();
  const auto large = test::writtenIndex(folder_, defaultContent(kBytes, 2, 2, 105));
  EXPECT_NEAR(static_cast<double>(large->bytes() - bytes) / 400, static_cast<double>(kBytes) + 8, 5)
      << "beside them directions, lists";
}

TEST_P(DefaultIndex, ExactSearchEqualsBruteForce) {
  const auto index = make(12, 3, 9);
  const auto search = makeExactSearch(index);
  for (int i = 0; i < 50; ++i) {
    const Code code = randomCode();
    const Neighbours all = sortedViews(*index, code, kAll);
    const Nearest& found = search->find(code.data());
    EXPECT_EQ(pairsOf(found.views), head(all, kNearestViews));
    EXPECT_EQ(pairsOf(found.categories), firstOfCategories(*index, all));
    EXPECT_EQ(found.scanned, index->viewCount());
  }
}

TEST_P(DefaultIndex, AllListsEqualBruteForceAmongTheNearest) {
  const auto index = make(40, 2, 6);
  const auto search = makeListSearch(index, kLists);
  for (int i = 0; i < 50; ++i) {
    const Code code = randomCode();
    const std::uint32_t left_out = i % 2 == 0 ? Search::kNone : static_cast<std::uint32_t>(random_.below(80));
    std::vector<std::uint8_t> categories(i % 3 == 0 ? 40 : 0, 1);
    if (!categories.empty()) std::fill_n(categories.begin(), 25, 0);
    const Neighbours all = sortedViews(*index, code, [&](std::uint32_t view) {
      const std::uint32_t model = index->modelOf(view);
      return model != left_out && (categories.empty() || index->models()[model].category >= 25);
    });
    const Nearest& found = search->find(code.data(), {{categories.data(), categories.size()}, left_out});
    EXPECT_EQ(pairsOf(found.views), head(all, kNearestViews));
    EXPECT_EQ(pairsOf(found.categories), firstOfCategories(*index, head(all, kCategoryPool)));
    EXPECT_EQ(found.scanned, all.size());
  }
}

TEST_P(DefaultIndex, NearestListsAreComparedInFull) {
  const auto index = make(40, 2, 6);
  const Projection& projection = *index->projection();
  const auto search = makeListSearch(index, 3);
  for (int i = 0; i < 50; ++i) {
    const Code code = randomCode();
    const CodeNumbers plain = unpackCode(code.data(), kBytes);
    Neighbours lists;  // that hold something
    for (const Key list : index->keys()) {
      const std::int8_t* const centroid = projection.centroids() + list * kCodeNumbers;
      lists.emplace_back(squaresOf({plain.begin(), plain.end()}, {centroid, centroid + kCodeNumbers}),
                         static_cast<std::uint32_t>(list));
    }
    std::sort(lists.begin(), lists.end());
    const auto among = [&](std::size_t probed) {
      return sortedViews(*index, code, [&](std::uint32_t view) {
        const std::uint32_t list = projection.listOf(unpackCode(index->code(view), kBytes));
        return std::any_of(lists.begin(), lists.begin() + static_cast<std::ptrdiff_t>(std::min(probed, lists.size())),
                           [&](const auto& entry) { return entry.second == list; });
      });
    };
    std::size_t probed = 3;
    while (firstOfCategories(*index, among(probed)).size() < 5 && probed < lists.size()) probed *= 2;
    const Nearest& found = search->find(code.data());
    EXPECT_EQ(pairsOf(found.views), head(among(probed), kNearestViews));
    EXPECT_EQ(found.scanned, among(probed).size());
  }
}

TEST_P(DefaultIndex, AScopeIsSearchedAmongAsManyViewsAsTheWhole) {
  const auto index = make(40, 2, 6);
  std::vector<std::uint8_t> fourth(40, 0);
  std::fill_n(fourth.begin(), 10, 1);
  const Span<const std::uint8_t> categories{fourth.data(), fourth.size()};
  for (int i = 0; i < 20; ++i) {
    const Code code = randomCode();
    const auto few = makeListSearch(index, 3), more = makeListSearch(index, 12);
    const Neighbours found = pairsOf(few->find(code.data(), {categories}).views);
    const Neighbours whole = pairsOf(more->find(code.data()).views);
    for (const auto& [distance, view] : whole) {
      if (index->models()[index->modelOf(view)].category >= 10) continue;
      EXPECT_NE(std::find(found.begin(), found.end(), std::pair(distance, view)), found.end()) << view;
    }
  }
}

TEST_P(DefaultIndex, FiveCategoriesAreMetWhereverThereAreFive) {
  const auto index = make(5, 1, 200);  // kCategoryPool views may be of two
  for (const int lists : {1, 100}) {
    for (int i = 0; i < 20; ++i) {
      const Code code = randomCode();
      const auto search = makeListSearch(index, lists);
      EXPECT_EQ(search->find(code.data()).categories.size, 5u);
    }
  }
}

TEST_P(DefaultIndex, FewCategoriesAreAllMet) {
  const auto index = make(3, 1, 5);
  const Code code = randomCode();
  EXPECT_EQ(makeListSearch(index, 1)->find(code.data()).scanned, 15u);
  EXPECT_EQ(makeListSearch(index, -7)->find(code.data()).scanned, 15u);
  EXPECT_EQ(makeListSearch(index, 1000000)->find(code.data()).scanned, 15u);
}

TEST_P(DefaultIndex, TheProfileChoosesTheSearch) {
  const auto index = make(6, 2, 5);
  SearchParams params;
  params.exact = false;
  params.lists = 1000;
  const Code code = randomCode();
  EXPECT_EQ(makeSearch(index, params)->find(code.data()).scanned, index->viewCount());
}

// ---- codes moved towards their categories' means -----------------------------------------------------------------

double lengthOf(const Numbers& numbers) {
  return std::sqrt(std::inner_product(numbers.begin(), numbers.end(), numbers.begin(), 0.0));
}

/// In floating point; `mean` may be empty.
double slowMovedDistance(const Code& query, const std::uint8_t* code, const Numbers& mean) {
  const Numbers q = slowNumbers(query.data(), query.size());
  Numbers moved = slowNumbers(code, query.size());
  for (std::size_t i = 0; i < mean.size(); ++i) moved[i] += (mean[i] - moved[i]) / 3;
  const double stretch = kCodeLength / lengthOf(moved);
  double sum = 0;
  for (std::size_t i = 0; i < q.size(); ++i) sum += (q[i] - stretch * moved[i]) * (q[i] - stretch * moved[i]);
  return sum;
}

Numbers slowMean(const Index& index, std::uint32_t category, std::uint32_t left_out) {
  Numbers sums(kCodeNumbers);
  int views = 0;
  for (std::uint32_t view = 0; view < index.viewCount(); ++view) {
    const std::uint32_t model = index.modelOf(view);
    if (model == left_out || index.models()[model].category != category) continue;
    const Numbers code = slowNumbers(index.code(view), index.profile().codeBytes());
    for (std::size_t i = 0; i < kCodeNumbers; ++i) sums[i] += code[i];
    ++views;
  }
  if (views == 0) return {};
  for (double& sum : sums) sum = std::round(sum / views);
  return sums;
}

TEST_P(DefaultIndex, HoldsTheMeansOfItsCategories) {
  const auto index = make(5, 3, 7);
  for (std::uint32_t category = 0; category < 5; ++category) {
    const Numbers mean = slowMean(*index, category, Search::kNone);
    EXPECT_TRUE(std::equal(mean.begin(), mean.end(), index->mean(category))) << category;
  }
}

TEST(CodeMean, RoundsHalvesAwayFromZero) {
  CodeMean mean(kCodeBytes);
  Code code(kCodeBytes, 0x88);
  for (int i = 0; i < 31; ++i) mean.add(code.data());
  code[0] = 0x79;
  mean.add(code.data());  // a step of sixteen of 32 codes
  CodeNumbers rounded{};
  mean.write(rounded.data());
  EXPECT_EQ(rounded[0], 1);
  EXPECT_EQ(rounded[kCodeBytes], -1);
  EXPECT_EQ(rounded[1], 0);
}

std::set<std::uint32_t> viewsOf(const Neighbours& found) {
  std::set<std::uint32_t> views;
  for (const auto& [distance, view] : found) views.insert(view);
  return views;
}

TEST_P(DefaultIndex, WhatIsFoundIsMeasuredTowardsTheMeans) {
  const auto index = make(8, 3, 9);
  const auto search = makeSearch(index, {});
  for (int i = 0; i < 20; ++i) {
    const Code code = randomCode();
    const std::uint32_t left_out = i % 2 == 0 ? Search::kNone : static_cast<std::uint32_t>(random_.below(24));
    const Nearest& found = search->find(code.data(), {{}, left_out});
    ASSERT_EQ(found.views.size, std::size_t{kNearestViews});
    ASSERT_EQ(found.categories.size, 8u);
    for (const Neighbour& n : found.views) {
      const Numbers mean = slowMean(*index, index->models()[index->modelOf(n.view)].category, left_out);
      ASSERT_NE(index->modelOf(n.view), left_out);
      ASSERT_NEAR(n.distance, slowMovedDistance(code, index->code(n.view), mean), 8) << n.view;
    }
    EXPECT_TRUE(std::is_sorted(found.views.begin(), found.views.end()));
    EXPECT_TRUE(std::is_sorted(found.categories.begin(), found.categories.end()));
    EXPECT_EQ(found.categories[0].view, found.views[0].view);
    const Neighbours all = sortedViews(*index, code, [&](std::uint32_t v) { return index->modelOf(v) != left_out; });
    EXPECT_EQ(viewsOf(pairsOf(found.views)), viewsOf(head(all, kNearestViews))) << "the nearest by their own codes";
  }
}

TEST_P(DefaultIndex, TheOnlyModelOfACategoryLeavesItWithoutAMean) {
  const auto index = make(6, 1, 4);
  const Code code = randomCode();
  EXPECT_EQ(makeSearch(index, {})->find(code.data(), {{}, 2}).categories.size, 5u);
}

// ---- damage ----------------------------------------------------------------------------------------------------

void useIt(const std::shared_ptr<const Index>& index) {
  std::vector<std::uint8_t> every_second(index->categories().size);
  for (std::size_t i = 0; i < every_second.size(); i += 2) every_second[i] = 1;
  const Code code(index->parameters().code_bytes, 3);
  SearchParams lists;
  lists.exact = false;
  for (const auto& search : {makeExactSearch(index), makeListSearch(index, 2), makeListSearch(index, 100),
                             makeSearch(index, {}), makeSearch(index, lists)}) {
    (void)search->find(code.data(), {{every_second.data(), every_second.size()}});
    const Nearest& nearest = search->find(code.data(), {{}, 1});
    const Answer answer = classify(*index, nearest, ClassifyMethod::Vote, 0);
    for (int i = 0; i < answer.count; ++i) {
      EXPECT_LT(answer.alternatives[static_cast<std::size_t>(i)].category, index->categories().size);
      index->modelName(index->view(answer.alternatives[static_cast<std::size_t>(i)].view).model);
    }
  }
  (void)readContent(*index);
}

struct Damage {
  const char* tag;
  std::size_t at;
  std::uint32_t value;
  std::size_t bytes;
};

TEST_P(DefaultIndex, ReferencesThatLieAreHarmlessAndFound) {
  const std::string path = make(3, 2, 2)->path(), good = readBytes(path);
  constexpr std::uint32_t kFar = 0xffffffff;
  for (const Damage& damage : {Damage{"VIE4", 4, 200, 1}, Damage{"MODL", 32 + 16, kFar, 4}, Damage{"MODL", 16, 5, 4},
                               Damage{"MODL", 20, kFar, 4}, Damage{"MEAN", 3, 99, 1}, Damage{"KEYS", 0, kFar, 4},
                               Damage{"KEYS", 4, kFar, 4}, Damage{"BKTV", 0, kFar, 4}, Damage{"BKTO", 4, kFar, 4}}) {
    std::string bytes = good;
    auto& header = *reinterpret_cast<format::Header*>(bytes.data());
    auto* const table = reinterpret_cast<format::Section*>(bytes.data() + sizeof(format::Header));
    const auto section = std::find_if(table, table + header.sections,
                                      [&](const format::Section& s) { return std::memcmp(s.tag, damage.tag, 4) == 0; });
    std::memcpy(bytes.data() + section->offset + damage.at, &damage.value, damage.bytes);
    section->crc32c = crc32c(bytes.data() + section->offset, section->length);
    header.crc32c = 0;
    header.crc32c = crc32c(bytes.data(), sizeof header + header.sections * sizeof(format::Section));
    writeBytes(path, bytes);
    const auto index = Index::open(path);
    ASSERT_TRUE(index.ok()) << index.status.sentence;
    useIt(index.value);
    EXPECT_EQ(index.value->verify().kind, Status::Kind::Damaged) << damage.tag << damage.at;
  }
}

INSTANTIATE_TEST_SUITE_P(OfEitherSize, DefaultIndex, testing::Values(kSmallCodeBytes, kCodeBytes),
                         [](const testing::TestParamInfo<std::size_t>& bytes) {
                           return std::to_string(bytes.param) + "Bytes";
                         });

}  // namespace
}  // namespace voxid
