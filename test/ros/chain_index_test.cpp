// SPDX-License-Identifier: BSD-3-Clause
// What is learnt while the chain runs: `voxid add`, as a person would call it.
#include <gtest/gtest.h>
#include <ros/ros.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <future>
#include <string>

#include "chain_fixture.h"
#include "library/ply.h"

namespace voxid {
namespace {

namespace fs = std::filesystem;
using test::Chain;
using test::Listener;
using test::TableScene;
using Clock = std::chrono::steady_clock;

constexpr double kPickedUp_s = 1.0;

/// Two folders of models, each of one category, and an index of the first.
class LearningChain : public Chain {
 protected:
  LearningChain() : folder_(index_path_.string() + ".models") {
    Mesh block, wedge;
    block.vertices = {{0, 0, 0}, {3, 0, 0}, {0, 2, 0}, {3, 2, 0}, {0, 0, 1}, {3, 0, 1}, {0, 2, 1}, {3, 2, 1}};
    block.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                       {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    wedge.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    wedge.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    test::writePly(block, folder_ / "taught/block/a.ply");
    test::writePly(wedge, folder_ / "new/wedge/a.ply");
    voxid("build --models " + (folder_ / "taught").string() + " --out " + index_path_.string());
  }
  ~LearningChain() override { fs::remove_all(folder_); }

  /// When it ended.
  static Clock::time_point voxid(const std::string& words) {
    EXPECT_EQ(std::system((VOXID_BIN "/voxid " + words + " --views-every 16 2>/dev/null").c_str()), 0) << words;
    return Clock::now();
  }
  Clock::time_point addWedge() const {
    return voxid("add " + index_path_.string() + " --models " + (folder_ / "new").string());
  }

  const fs::path folder_;
};

bool knows(const Objects& objects, const std::string& category) {
  const auto names = [&](const Candidate& candidate) { return candidate.label == category; };
  return std::any_of(objects.objects.begin(), objects.objects.end(), [&](const Object& object) {
    return std::any_of(object.alternatives.begin(), object.alternatives.end(), names);
  });
}

TEST_F(LearningChain, WhatIsAddedIsKnownWithinASecondAndNoFrameIsLost) {
  start();
  Listener<Objects> listener(node_, "objects");
  const auto depth_mm = TableScene().depth_mm();
  ObjectsConstPtr answer = answerTo(depth_mm, listener);
  ASSERT_TRUE(answer && knows(*answer, "block") && !knows(*answer, "wedge"));

  std::future<Clock::time_point> added = std::async(std::launch::async, [this] { return addWedge(); });
  const Clock::time_point latest = Clock::now() + std::chrono::seconds(30);
  int before = 0;
  for (; !knows(*answer, "wedge") && Clock::now() < latest; ++before) {
    answer = listener.wait(show(depth_mm), 5);
    ASSERT_TRUE(answer) << "frame " << before << " was lost";
    ASSERT_TRUE(knows(*answer, "block"));
  }
  const std::chrono::duration<double> waited = Clock::now() - added.get();
  EXPECT_LT(waited.count(), kPickedUp_s);
  EXPECT_GT(before, 1);
  for (int after = 0; after < 20; ++after) {
    answer = listener.wait(show(depth_mm), 5);
    ASSERT_TRUE(answer && knows(*answer, "wedge") && knows(*answer, "block"));
  }
}

}  // namespace
}  // namespace voxid
