// SPDX-License-Identifier: BSD-3-Clause
// Threads share a frame's objects; messages are used again.
#include "recogniser_pool.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <random>
#include <set>
#include <tuple>

#include "message_pool.h"
#include "scene_index.h"

namespace voxid {
namespace {

class Pool : public testing::Test {
 protected:
  Pool()
      : path_(std::filesystem::temp_directory_path() / ("pool" + std::to_string(getpid()) + ".vxi")),
        image_(test::imageOf(test::TableScene().depth_mm(), ros::Time(1))),
        depth_(viewOf(*image_, *test::infoOf(ros::Time(1))).value) {
    test::writeSceneIndex(path_);
    index_ = Index::open(path_).value;
    const Scene& scene = segmenter_.segment(depth_, {});
    // Whole clusters and slices of them: objects of many sizes, of which none is like the next.
    for (std::size_t i = 0; i < 24; ++i) {
      const ObjectPixels all = scene.clusters[i % scene.clusters.size].pixels;
      objects_.push_back({all.data, all.size - i * (all.size / 40)});
    }
  }
  ~Pool() override { std::filesystem::remove(path_); }

  /// What is said of an object.
  using Said = std::tuple<int, std::uint16_t, std::uint32_t, std::uint32_t, std::uint32_t>;
  static Said saidOf(const Answer& answer) {
    const Alternative& best = answer.alternatives[0];
    return {answer.count, answer.score_permille, answer.margin_permille, best.view, best.distance};
  }
  static std::vector<Said> saidBy(RecogniserPool& pool, const DepthView& depth,
                                  const std::vector<ObjectPixels>& objects) {
    std::vector<Said> said;
    for (const Answer& answer : pool.recogniseAll(depth, {objects.data(), objects.size()}, {}))
      said.push_back(saidOf(answer));
    return said;
  }

  const std::filesystem::path path_;
  const sensor_msgs::ImagePtr image_;
  const DepthView depth_;
  Segmenter segmenter_;
  std::shared_ptr<const Index> index_;
  std::vector<ObjectPixels> objects_;
};

TEST_F(Pool, AnswersDoNotDependOnTheNumberOfThreads) {
  RecogniserPool alone(index_, nullptr, 1);
  const std::vector<Said> expected = saidBy(alone, depth_, objects_);
  ASSERT_EQ(expected.size(), objects_.size());
  EXPECT_GT(std::set<Said>(expected.begin(), expected.end()).size(), 10u);  // else an exchange would not be seen
  for (const int threads : {2, 3, 8}) {
    RecogniserPool pool(index_, nullptr, threads);
    EXPECT_EQ(pool.threads(), threads);
    for (int frame = 0; frame < 20; ++frame) EXPECT_EQ(saidBy(pool, depth_, objects_), expected) << threads;
  }
}

TEST_F(Pool, AnAnswerDoesNotDependOnItsPlaceInTheFrame) {
  RecogniserPool pool(index_, nullptr, 4);
  const std::vector<Said> expected = saidBy(pool, depth_, objects_);
  std::vector<std::size_t> order(objects_.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::mt19937 generator(7);
  for (int round = 0; round < 10; ++round) {
    std::shuffle(order.begin(), order.end(), generator);
    std::vector<ObjectPixels> shuffled;
    std::vector<Said> expected_here;
    for (const std::size_t i : order) {
      shuffled.push_back(objects_[i]);
      expected_here.push_back(expected[i]);
    }
    EXPECT_EQ(saidBy(pool, depth_, shuffled), expected_here);
  }
}

TEST_F(Pool, WhatElseIsDoneForAnObjectIsDoneOnce) {
  for (const int threads : {1, 4}) {
    RecogniserPool pool(index_, nullptr, threads);
    std::vector<int> done(objects_.size());
    pool.recogniseAll(depth_, {objects_.data(), objects_.size()}, {}, [&](std::size_t i) { ++done[i]; });
    EXPECT_EQ(done, std::vector<int>(objects_.size(), 1));
  }
}

TEST_F(Pool, FramesWithFewObjectsOrNone) {
  RecogniserPool pool(index_, nullptr, 4);
  EXPECT_TRUE(saidBy(pool, depth_, {}).empty());
  const std::vector<Said> all = saidBy(pool, depth_, objects_);
  EXPECT_EQ(saidBy(pool, depth_, {objects_[3]}), (std::vector<Said>{all[3]}));
  const std::vector<Said> with_empty = saidBy(pool, depth_, {objects_[3], {}, objects_[5]});
  EXPECT_EQ(std::get<0>(with_empty[1]), 0);  // nothing to compare
  EXPECT_EQ(with_empty[2], all[5]);
}

TEST_F(Pool, HelpersCountTheirProcessorTime) {
  RecogniserPool alone(index_, nullptr, 1), pool(index_, nullptr, 3);
  for (int frame = 0; frame < 50; ++frame) {
    saidBy(alone, depth_, objects_);
    saidBy(pool, depth_, objects_);
  }
  EXPECT_EQ(alone.helpersCpuMs(), 0);
  EXPECT_GT(pool.helpersCpuMs(), 0);
}

TEST(MessagePool, TakesWhatNobodyHoldsAndKeepsItsMemory) {
  MessagePool<sensor_msgs::Image> pool;
  auto first = pool.take();
  first->data.resize(1000);
  const std::uint8_t* const memory = first->data.data();
  const auto second = pool.take();
  EXPECT_NE(first, second);
  sensor_msgs::ImageConstPtr listener = first;
  first.reset();
  EXPECT_NE(pool.take(), listener);
  listener.reset();
  const auto again = pool.take();
  EXPECT_EQ(again->data.data(), memory);
  EXPECT_EQ(again->data.size(), 1000u);
}

TEST(MessagePool, AListenerThatKeepsEverythingGetsNewMessages) {
  MessagePool<sensor_msgs::Image> pool;
  std::set<sensor_msgs::ImagePtr> held;
  for (int i = 0; i < 100; ++i) held.insert(pool.take());
  EXPECT_EQ(held.size(), 100u);
}

}  // namespace
}  // namespace voxid
