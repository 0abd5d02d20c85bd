// SPDX-License-Identifier: BSD-3-Clause
// Every parameter of the chain, changed while it runs: the next frame is answered by it.
#include <gtest/gtest.h>
#include <ros/ros.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <set>
#include <type_traits>

#include "chain_fixture.h"
#include "core/index_fixture.h"
#include "core/projection_fixture.h"

namespace voxid {
namespace {

using test::Chain;
using test::infoOf;
using test::Listener;
using test::reconfigure;
using test::TableScene;

/// A name, whether it is a bool, and one of its limits.
struct Setting {
  std::string name;
  bool boolean;
  int value, usual;
};
template <typename Params>
std::vector<Setting> settingsOf(Params params = {}) {
  std::vector<Setting> settings;
  visitParams(params, [&](const char* name, auto& value, auto least, auto most) {
    const bool boolean = std::is_same_v<std::decay_t<decltype(value)>, bool>;
    for (const int limit : {static_cast<int>(least), static_cast<int>(most)})
      if (limit != static_cast<int>(value)) settings.push_back({name, boolean, limit, static_cast<int>(value)});
  });
  return settings;
}
template <typename Params>
Params with(const Setting& setting, Params params = {}) {
  visitParams(params, [&](const char* name, auto& value, auto, auto) {
    if (name == setting.name) value = static_cast<std::decay_t<decltype(value)>>(setting.value);
  });
  return params;
}

template <typename Params>
std::set<std::string> namesOf() {
  std::set<std::string> names;
  Params params;
  visitParams(params, [&](const char* name, auto&, auto, auto) { names.insert(name); });
  return names;
}

/// A few millimetres of noise, the same in each run.
std::vector<std::uint16_t> noisy(std::vector<std::uint16_t> depth_mm) {
  std::uint32_t random = 1;
  for (std::uint16_t& depth : depth_mm) {
    random = random * 1664525u + 1013904223u;
    if (depth > 0) depth = static_cast<std::uint16_t>(depth + (random >> 28) % 7 - 3);
  }
  return depth_mm;
}

/// Things apart from each other.
std::vector<std::uint16_t> scatteredThings() {
  TableScene scene;
  scene.boxes.push_back({{0.0, 0.80, 0.01}, {0.10, 0.08, 0.02}});
  scene.boxes.push_back({{-0.10, 0.62, 0.03}, {0.05, 0.06, 0.06}});
  return scene.depth_mm();
}

/// Cut by a nearer one, stacked, side by side, and beyond the table's edge; stripes without depth.
std::vector<std::uint16_t> crowdedThings() {
  TableScene scene;
  scene.boxes = {{{0, 0.90, 0.05}, {0.5, 0.06, 0.10}},     {{0, 0.62, 0.10}, {0.06, 0.06, 0.20}},
                 {{-0.2, 0.66, 0.04}, {0.10, 0.10, 0.08}}, {{-0.2, 0.66, 0.11}, {0.05, 0.05, 0.06}},
                 {{0.3, 0.60, 0.03}, {0.10, 0.06, 0.06}},  {{0.3, 0.64, 0.034}, {0.10, 0.02, 0.068}},
                 {{0.47, 0.75, 0.05}, {0.08, 0.08, 0.10}}};
  scene.balls = {{{0.22, 0.80, 0.06}, 0.06}};
  std::vector<std::uint16_t> depth_mm = noisy(scene.depth_mm());
  for (std::size_t i = 0; i < depth_mm.size(); ++i) {
    const std::size_t column = i % TableScene::kWidth;
    if (column % 40 >= 30 && column % 40 < 34) depth_mm[i] = 0;
  }
  return depth_mm;
}

/// Boxes in two rows that leave little of a small table.
std::vector<std::uint16_t> coveredTable(int boxes) {
  TableScene scene;
  scene.table_half_m = 0.3;
  scene.balls.clear();
  scene.boxes.clear();
  for (int i = 0; i < boxes; ++i) {
    const double height_m = 0.04 + 0.02 * (i % 5);
    scene.boxes.push_back({{-0.2 + 0.1 * (i % 5), 0.58 + 0.14 * (i / 5), height_m / 2}, {0.09, 0.11, height_m}});
  }
  return noisy(scene.depth_mm());
}

bool differ(const Segments& a, const Segments& b) {
  return a.status != b.status || a.valid_pixels != b.valid_pixels || a.table != b.table || a.segments != b.segments ||
         a.dropped != b.dropped;
}

TEST_F(Chain, EveryParameterOfTheSegmentationWorksInTheNextFrame) {
  start();
  Listener<Segments> listener(node_, "segments");
  Segmenter segmenter;
  const auto segmented = [&](const SegmentParams& params) {
    Segments segments;
    fillSegments(segmenter.segment(viewOf(*sent_, *infoOf(ros::Time(1))).value, params), 320, 240, &segments);
    return segments;
  };
  std::set<std::string> seen;  // in a scene that shows a difference
  for (const auto& depth_mm : {scatteredThings(), crowdedThings(), coveredTable(6), coveredTable(10)}) {
    ASSERT_TRUE(answerTo(depth_mm, listener));
    const Segments usual = segmented({});
    for (const Setting& setting : settingsOf<SegmentParams>()) {
      const Segments expected = segmented(with<SegmentParams>(setting));
      if (seen.count(setting.name) || !differ(expected, usual)) continue;
      reconfigure(name_ + "/segmentation", setting.name, setting.boolean, setting.value);
      const SegmentsConstPtr heard = listener.wait(show(depth_mm), 5);
      ASSERT_TRUE(heard) << setting.name;
      EXPECT_FALSE(differ(*heard, expected)) << setting.name << " = " << setting.value;
      seen.insert(setting.name);
      reconfigure(name_ + "/segmentation", setting.name, setting.boolean, setting.usual);
      const SegmentsConstPtr again = listener.wait(show(depth_mm), 5);
      ASSERT_TRUE(again) << setting.name;
      EXPECT_FALSE(differ(*again, usual)) << setting.name << " = " << setting.usual;
    }
  }
  EXPECT_EQ(seen, namesOf<SegmentParams>());
}

/// Threads of this process.
int threads() {
  const std::filesystem::directory_iterator tasks("/proc/self/task");
  return static_cast<int>(std::distance(begin(tasks), end(tasks)));
}

/// Of each parameter both limits; those that made a difference in the next frame.
class ClassificationSettings : public Chain {
 protected:
  std::set<std::string> seen(const ClassifyParams& usual) {
    node_.setParam("classification/radius_bits", usual.radius_bits);
    node_.setParam("classification/memory", false);  // each frame by itself
    start();
    const std::shared_ptr<const Index> index = Index::open(index_path_).value;
    std::set<std::string> seen;
    const Listener<Objects>::Ptr first = answerTo(scene_, objects_);
    if (!first) return seen;
    const int threads_before = threads();
    for (const Setting& setting : settingsOf(usual)) {
      reconfigure(name_ + "/classification", setting.name, setting.boolean, setting.value);
      const ObjectsConstPtr heard = objects_.wait(show(scene_), 5);
      if (!heard) return {};
      const std::vector<Object> expected = answers(index, with(setting, usual));
      expectSame(*heard, expected, setting.name + " = " + std::to_string(setting.value));
      if (differ(expected, answers(index, usual)) || threads() != threads_before) seen.insert(setting.name);
      if (setting.name == "threads") {
        EXPECT_EQ(threads(), threads_before + setting.value - setting.usual);
      }
      reconfigure(name_ + "/classification", setting.name, setting.boolean, setting.usual);
      if (!objects_.wait(show(scene_), 5)) return {};
    }
    return seen;
  }

 private:
  std::vector<Object> answers(const std::shared_ptr<const Index>& index, const ClassifyParams& params) {
    const DepthView depth = viewOf(*sent_, *infoOf(ros::Time(1))).value;
    Recogniser recogniser(index);
    std::vector<Object> objects;
    for (const Cluster& cluster : segmenter_.segment(depth, {}).clusters) {
      objects.emplace_back();
      fillAnswer(recogniser.recognise(depth, cluster.pixels, params), *index, &objects.back());
    }
    return objects;
  }
  static bool differ(const std::vector<Object>& a, const std::vector<Object>& b) {
    return !std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Object& p, const Object& q) {
      return p.label == q.label && p.score == q.score && p.alternatives == q.alternatives;
    });
  }
  static void expectSame(const Objects& heard, const std::vector<Object>& expected, const std::string& setting) {
    EXPECT_FALSE(differ(heard.objects, expected)) << setting;
  }

  const std::vector<std::uint16_t> scene_ = TableScene().depth_mm();
  Segmenter segmenter_;
  Listener<Objects> objects_{node_, "objects"};
};

TEST_F(ClassificationSettings, WorkInTheNextFrameByTheKeysOfThePapersDescriptor) {
  ASSERT_TRUE(writeIndex(test::randomContent(12, 3, 4, 5), index_path_).ok());
  ClassifyParams keys;
  keys.radius_bits = kPaperRadiusBits;
  EXPECT_EQ(seen(keys), (std::set<std::string>{"exact", "min_score_permille", "radius_bits", "threads", "vote"}));
}

TEST_F(ClassificationSettings, WorkInTheNextFrameByTheListsOfTheDefault) {
  IndexContent content = test::randomContent(12, 3, 4, 5);
  content.profile = {{}, test::projectionOf(test::randomProjectionContent(200, 1))};
  test::Random random(3);
  for (ModelRecord& model : content.models) {
    for (ViewRecord& view : model.views) {
      view.code.resize(kCodeBytes);
      for (std::uint8_t& numbers : view.code)
        numbers = static_cast<std::uint8_t>(0x11 + random.below(15) + 16 * random.below(15));
    }
  }
  ASSERT_TRUE(writeIndex(content, index_path_).ok());
  EXPECT_EQ(seen({}), (std::set<std::string>{"exact", "lists", "min_score_permille", "threads", "vote"}));
}

}  // namespace
}  // namespace voxid
