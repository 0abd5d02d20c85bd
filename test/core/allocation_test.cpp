// SPDX-License-Identifier: BSD-3-Clause
// After construction the frame path takes no memory. This binary counts every allocation.
#include <gtest/gtest.h>

#include "core/clouds.h"
#include "core/index_fixture.h"
#include "core/projection_fixture.h"
#include "counted_allocations.h"
#include "voxid/core/classifier.h"
#include "voxid/core/encoder.h"
#include "voxid/core/search.h"
#include "voxid/core/sketch.h"

namespace voxid {
namespace {

template <typename Work>
int allocationsIn(Work work) {
  const int before = allocations;
  work();
  return allocations - before;
}

TEST(Allocation, IsCounted) {
  EXPECT_GT(allocationsIn([] { std::vector<int>(100).swap(*std::make_unique<std::vector<int>>()); }), 0);
}

TEST(Allocation, DescribeTakesNone) {
  const test::Cloud mug = test::mug(), many(100000, PointUm{1, 2, 3});
  const std::vector<std::uint16_t> depth(640 * 480, 800);
  std::vector<std::uint32_t> pixels(80000);
  for (std::uint32_t i = 0; i < pixels.size(); ++i) pixels[i] = i;
  const DepthView view{depth.data(), 640, 480, 1280, DepthUnit::MillimetreU16, Camera::fromPixels(525, 525, 320, 240)};
  Describer describer;
  EXPECT_EQ(allocationsIn([&] {
              (void)describer.describe(test::spanOf(mug));
              (void)describer.describe(test::spanOf(many));
              (void)describer.describe(view, {pixels.data(), pixels.size()});
            }),
            0);
}

void expectTheDefaultProfileTakesNone(bool small) {
  test::Folder folder;
  IndexContent content = test::randomContent(30, 2, 8, 1);
  content.profile = {{}, test::projectionOf(test::randomProjectionContent(40, 1)), small};
  test::Random random(2);
  for (ModelRecord& model : content.models) {
    for (ViewRecord& view : model.views) {
      view.code.resize(content.profile.codeBytes());
      for (std::uint8_t& number : view.code) number = static_cast<std::uint8_t>(random.bits());
    }
  }
  const auto index = test::writtenIndex(folder, content);
  const auto encoder = makeEncoder(index->profile());
  const auto exact = makeExactSearch(index), lists = makeListSearch(index, 3);
  const std::vector<std::uint16_t> depth(640 * 480, 800);
  std::vector<std::uint32_t> pixels(80000);
  for (std::uint32_t i = 0; i < pixels.size(); ++i) pixels[i] = i;
  const DepthView view{depth.data(), 640, 480, 1280, DepthUnit::MillimetreU16, Camera::fromPixels(525, 525, 320, 240)};
  std::vector<std::uint8_t> code(kCodeBytes);
  EXPECT_EQ(allocationsIn([&] {
              EXPECT_EQ(encoder->encode(view, {pixels.data(), pixels.size()}, code.data()), DescribeStatus::Ok);
              for (Search* const search : {exact.get(), lists.get()}) {
                (void)classify(*index, search->find(code.data(), {{}, 1}), ClassifyMethod::Vote, 0);
              }
            }),
            0);
}

TEST(Allocation, TheDefaultProfileTakesNone) { expectTheDefaultProfileTakesNone(false); }

TEST(Allocation, TheDefaultProfileInSmallCodesTakesNone) { expectTheDefaultProfileTakesNone(true); }

TEST(Allocation, FindAndClassifyTakeNone) {
  test::Folder folder;
  const auto index = test::writtenIndex(folder, test::randomContent(32, 4, 8, 1));
  const auto exact = makeExactSearch(index), lsh = makeLshSearch(index, 4), sketch = makeSketchSearch(index);
  ASSERT_FALSE(sketchesOf(*index).empty());
  for (Search* const search : {exact.get(), lsh.get(), sketch.get()}) {
    EXPECT_EQ(allocationsIn([&] {
                for (std::uint32_t view = 0; view < 20; ++view) {
                  const Nearest& nearest = search->find(index->code(view), {{}, view % 3});
                  (void)classify(*index, nearest, ClassifyMethod::Vote, 0);
                  (void)classify(*index, nearest, ClassifyMethod::OneNn, 0);
                }
              }),
              0);
  }
}

}  // namespace
}  // namespace voxid
