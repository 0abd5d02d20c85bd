// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/library/aligned_naming.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>

#include "core/index_fixture.h"
#include "geometry/solids.h"
#include "library/ply.h"
#include "voxid/library/renderer.h"
#include "voxid/library/sensor_model.h"

namespace voxid {
namespace {

namespace fs = std::filesystem;

class AlignedNamingTest : public testing::Test {
 protected:
  ~AlignedNamingTest() override { fs::remove_all(folder_); }

  /// Models c100/m0, c101/m0 and so on, `models` of each category, all of them `mesh`.
  void write(const Mesh& mesh, int categories, int models) {
    const IndexContent content = test::randomContent(categories, models, 1, 1);
    for (const ModelRecord& model : content.models)
      test::writePly(mesh, folder_ / model.category / (model.name + ".ply"));
    index_ = test::writtenIndex(files_, content);
  }

  /// What the codes say: every category's first model, all of them as near.
  Nearest asNear(std::uint32_t distance) {
    views_.clear();
    for (const format::Category& category : index_->categories())
      views_.push_back({index_->models()[category.first_model].first_view, distance});
    const Span<const Neighbour> views{views_.data(), views_.size()};
    return {views, views, 0};
  }

  test::Folder files_;
  const fs::path folder_ = fs::temp_directory_path() / ("voxid_naming_" + std::to_string(getpid()));
  std::shared_ptr<const Index> index_;
  std::vector<Neighbour> views_;
};

/// Of a category's only model.
SketchedModel sketched(std::uint32_t model, float misfit, std::uint32_t drawn_distance) {
  SketchedModel candidate;
  candidate.model = candidate.view = model;
  candidate.distance = 1000;
  candidate.sketches = {{Placement(), misfit}};
  candidate.drawn_distance = drawn_distance;
  return candidate;
}

TEST_F(AlignedNamingTest, WhatLooksMoreLikeTheObjectWhereItWasFoundIsNamed) {
  write(test::corner(), 3, 1);
  const AlignedNaming naming(index_, folder_);
  const Nearest nearest = asNear(1000);
  const auto named = [&](const std::vector<SketchedModel>& candidates) {
    return naming.name(nearest, candidates, 0).alternatives[0].category;
  };
  EXPECT_EQ(named({sketched(0, 0.1f, 900), sketched(1, 0.1f, 800), sketched(2, 0.1f, 850)}), 1u);
  EXPECT_EQ(named({sketched(0, 0.1f, 1100), sketched(1, 0.1f, 1200), sketched(2, 0.1f, Search::kNone)}), 2u)
      << "what is not drawn counts as far as its nearest view";
  EXPECT_EQ(named({sketched(0, 0.1f, 900), sketched(1, 0.1f, 850), sketched(2, 0.05f, 1000)}), 2u)
      << "how well it fits counts more";
}

TEST_F(AlignedNamingTest, TheTwoOfEachCategoryThatFitBestAreDrawn) {
  write(test::corner(), 2, 3);
  RayScene scene;
  const Mesh mesh = test::corner();
  scene.add(mesh, unitPlacement(mesh));
  scene.commit();
  const DepthImage image =
      observe(scene, Imager(), drawPose(index_->directions()[0], Imager(), ViewRange(), 3), SensorParams(), 4);
  const std::vector<std::uint32_t> pixels = image.setPixels();
  ObservedObject object;
  object.depth = image.view();
  object.pixels = {pixels.data(), pixels.size()};
  std::vector<std::uint8_t> code(index_->profile().codeBytes());
  ASSERT_EQ(makeEncoder(index_->profile())->encode(object.depth, object.pixels, code.data()), DescribeStatus::Ok);

  AlignedNaming naming(index_, folder_);
  auto candidates = naming.candidates(code.data(), asNear(1000));
  ASSERT_TRUE(candidates.ok()) << candidates.status.sentence;
  naming.sketch(object, candidates.value);
  ASSERT_EQ(candidates.value.size(), 6u);
  for (std::size_t category = 0; category < 2; ++category) {
    const SketchedModel* const first = &candidates.value[3 * category];
    const auto drawn = [](const SketchedModel& c) { return c.drawn_distance != Search::kNone; };
    EXPECT_EQ(std::count_if(first, first + 3, drawn), 2);
    const auto nearest = std::min_element(first, first + 3, [](const SketchedModel& a, const SketchedModel& b) {
      return a.drawn_distance < b.drawn_distance;
    });
    EXPECT_LT(nearest->drawn_distance, nearest->distance / 2)
        << "the index holds chance codes, the drawing is the object";
  }
}

}  // namespace
}  // namespace voxid
