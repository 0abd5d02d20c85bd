// SPDX-License-Identifier: BSD-3-Clause
// The parts of the builder that its command line (test/cli/test_build.py) does not show.
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <fstream>
#include <map>
#include <thread>
#include <vector>

#include "../../src/library/calibrate.h"
#include "../../src/library/parts_folder.h"
#include "../../src/library/random.h"
#include "../../src/library/shard.h"
#include "../../src/library/worker_pool.h"

namespace voxid {
namespace {

namespace fs = std::filesystem;

TEST(Random, IsSplitMix64) {
  Random random(1234567);  // Vigna's reference values
  EXPECT_EQ(random.next(), 6457827717110365317u);
  EXPECT_EQ(random.next(), 3203168211198807973u);
}

TEST(Random, NormalHasMeanZeroAndDeviationOne) {
  Random random(1);
  double sum = 0, squares = 0;
  constexpr int kDraws = 100000;
  for (int i = 0; i < kDraws; ++i) {
    const double x = random.normal();
    sum += x;
    squares += x * x;
  }
  EXPECT_NEAR(sum / kDraws, 0, 0.01);
  EXPECT_NEAR(squares / kDraws, 1, 0.01);
}

TEST(PartsFolder, IsHeldByOneThoughOthersEndMeanwhile) {
  const fs::path folder = fs::path(testing::TempDir()) / ("voxid_parts_" + std::to_string(::getpid()));
  fs::create_directories(folder);
  const std::string out = (folder / "x.vxi").string();
  std::atomic<int> holders{0}, most{0}, turns{0};
  const auto work = [&] {
    for (int i = 0; i < 3000; ++i) {
      PartsFolder parts;
      if (!parts.open(out, true).ok()) continue;
      most = std::max(most.load(), ++holders);
      std::ofstream(parts.path() + "/0.shard") << "a model";
      EXPECT_TRUE(parts.hasModels());
      ++turns;
      --holders;
      parts.remove();
    }
  };
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i) threads.emplace_back(work);
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(most, 1);
  EXPECT_GT(turns, 0);
  EXPECT_TRUE(fs::is_empty(folder));
  fs::remove_all(folder);
}

TEST(FitCalibration, PoolsWhatFallsAndFillsWhatIsEmpty) {
  std::vector<int> right(32), asked(32);
  asked[1] = 98, right[1] = 49;  // one half
  asked[2] = 98, right[2] = 9;   // falls: pooled with the first, 58 of 196
  asked[31] = 98, right[31] = 98;
  const format::Calibration c = fitCalibration(right, asked);
  EXPECT_EQ(c.samples, 294u);
  for (int i = 0; i < 31; ++i) EXPECT_EQ(c.score_permille[i], 298) << i;  // (58 + 1) / (196 + 2)
  EXPECT_EQ(c.score_permille[31], 990);                                   // 99 / 100
}

TEST(FitCalibration, NeverFalls) {
  Random random(5);
  for (int round = 0; round < 200; ++round) {
    std::vector<int> right(32), asked(32);
    for (int i = 0; i < 32; ++i) {
      asked[i] = random.below(20);
      right[i] = random.below(asked[i] + 1);
    }
    const format::Calibration c = fitCalibration(right, asked);
    for (int i = 1; i < 32; ++i) EXPECT_LE(c.score_permille[i - 1], c.score_permille[i]);
    EXPECT_LE(c.score_permille[31], 1000);
  }
}

struct Seen {
  std::map<int, int> done;
  std::map<int, std::string> died;

  Status run(int jobs, int items, std::function<Result<int>(int)> work) {
    PoolWork pool;
    pool.items = items;
    pool.work = std::move(work);
    pool.onDone = [this](int item, int result) { done[item] = result; };
    pool.onDied = [this](int item, const std::string& how) { died[item] = how; };
    pool.onTick = [] {};
    return runInProcesses(jobs, pool);
  }
};

TEST(WorkerPool, EveryItemIsDoneOnceWithAnyNumberOfWorkers) {
  for (const int jobs : {1, 3, 50}) {
    Seen seen;
    ASSERT_TRUE(seen.run(jobs, 20, [](int item) { return item * item; }).ok());
    ASSERT_EQ(seen.done.size(), 20u);
    for (const auto& [item, result] : seen.done) EXPECT_EQ(result, item * item);
  }
}

TEST(WorkerPool, ACrashCostsItsItemOnly) {
  Seen seen;
  const auto work = [](int item) -> Result<int> {
    if (item % 3 == 0) raise(SIGKILL);
    return item;
  };
  ASSERT_TRUE(seen.run(2, 10, work).ok());
  EXPECT_EQ(seen.done.size(), 6u);
  ASSERT_EQ(seen.died.size(), 4u);
  for (const auto& [item, how] : seen.died) {
    EXPECT_EQ(item % 3, 0);
    EXPECT_EQ(how, "Killed");
  }
}

TEST(WorkerPool, ARefusalEndsEverything) {
  Seen seen;
  const auto work = [](int item) -> Result<int> {
    if (item == 5) return Status::cannotDo("the disk is full");
    return item;
  };
  const Status status = seen.run(2, 1000000, work);
  EXPECT_EQ(status.kind, Status::Kind::CannotDo);
  EXPECT_EQ(status.sentence, "the disk is full");
}

class Shard : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (fs::temp_directory_path() / "voxid-shard-XXXXXX").string();
    folder_ = mkdtemp(pattern.data());
    origin_.file = "mug/a.ply";
    views_.calibration = {1, 2, 3};
    ViewRecord view;
    view.direction = 7;
    view.points = 1234;
    view.extents = {1, 2, 65535};
    view.code.assign(416, 9);
    views_.views = {view, view};
    ASSERT_TRUE(writeShard(path(), origin_, views_).ok());
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string path() const { return (folder_ / "s").string(); }

  fs::path folder_;
  ShardOrigin origin_;
  ModelViews views_;
};

TEST_F(Shard, ComesBackAsItWas) {
  const Result<ModelViews> read = readShard(path(), origin_);
  ASSERT_TRUE(read.ok()) << read.status.sentence;
  EXPECT_EQ(read.value.calibration, views_.calibration);
  ASSERT_EQ(read.value.views.size(), 2u);
  EXPECT_EQ(read.value.views[1].code, views_.views[1].code);
  EXPECT_EQ(read.value.views[1].extents, views_.views[1].extents);
  EXPECT_EQ(read.value.views[1].points, 1234u);
}

TEST_F(Shard, OfAnotherFileOrOtherSettingsIsNotTaken) {
  ShardOrigin other = origin_;
  other.file_mtime_ns = 1;
  EXPECT_EQ(readShard(path(), other).status.kind, Status::Kind::CannotDo);
  other = origin_;
  other.parameters.pairs = 1;
  EXPECT_EQ(readShard(path(), other).status.kind, Status::Kind::CannotDo);
}

TEST_F(Shard, CutOrFlippedAnywhereIsDamaged) {
  std::ifstream in(path(), std::ios::binary);
  const std::string whole{std::istreambuf_iterator<char>(in), {}};
  for (std::size_t i = 0; i < whole.size(); i += 7) {
    std::string flipped = whole;
    flipped[i] = static_cast<char>(flipped[i] ^ 0x10);
    std::ofstream(path(), std::ios::binary) << flipped;
    EXPECT_EQ(readShard(path(), origin_).status.kind, Status::Kind::Damaged) << i;
    std::ofstream(path(), std::ios::binary) << whole.substr(0, i);
    EXPECT_EQ(readShard(path(), origin_).status.kind, Status::Kind::Damaged) << i;
  }
}

}  // namespace
}  // namespace voxid
