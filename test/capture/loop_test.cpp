// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/capture/capture_loop.h"

#include <atomic>
#include <thread>

#include "fixtures.h"

namespace voxid {
namespace {

class LoopTest : public ReplayTest {
 protected:
  void SetUp() override {
    params_.stall_ms = 400;
    params_.retry_first_ms = 50;
    params_.retry_most_ms = 200;
  }
  void run(CaptureLoop::Options options = {}) {
    CaptureLoop::Sink sink;
    sink.frame = [this](const CaptureFrame&, const Intrinsics&) {
      thread_ = std::this_thread::get_id();
      ++frames_;
    };
    sink.lost = [this](const std::string& sentence) {
      const std::lock_guard<std::mutex> lock(mutex_);
      losses_.push_back(sentence);
    };
    sink.recovered = [this] { ++recoveries_; };
    loop_ = std::make_unique<CaptureLoop>(std::move(options), sink);
    loop_->setParams(params_);
  }
  std::vector<std::string> losses() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return losses_;
  }
  bool framesCome() {
    const int before = frames_;
    return eventually([&] { return frames_ > before + 2; });
  }
  bool reaches(CaptureState state) {
    return eventually([&] { return loop_->snapshot().state == state; });
  }

  CaptureParams params_;
  std::atomic<int> frames_{0}, recoveries_{0};
  std::atomic<std::thread::id> thread_{};
  std::mutex mutex_;
  std::vector<std::string> losses_;
  std::unique_ptr<CaptureLoop> loop_;  // last: its thread uses the others
};

TEST_F(LoopTest, ReadsOnlyWhileSomebodyListens) {
  playFrames(2);
  run();
  EXPECT_EQ(loop_->snapshot().state, CaptureState::Idle);
  loop_->demand(true, false);
  EXPECT_TRUE(framesCome());
  EXPECT_EQ(loop_->snapshot().state, CaptureState::Running);
  loop_->demand(false, false);
  ASSERT_TRUE(reaches(CaptureState::Idle));
  const int then = frames_;
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  EXPECT_EQ(frames_, then);
  loop_->demand(true, false);
  EXPECT_TRUE(framesCome());
  EXPECT_TRUE(losses().empty());
}

// OpenNI2 crashes now and then in a process where a thread that has called it has ended.
TEST_F(LoopTest, ReadsOnAThreadThatTheNextLoopUsesAgain) {
  playFrames(2);
  const auto threadOfALoop = [this] {
    run();
    loop_->demand(true, false);
    EXPECT_TRUE(framesCome());
    loop_.reset();
    return thread_.load();
  };
  const std::thread::id first = threadOfALoop();
  EXPECT_NE(first, std::this_thread::get_id());
  EXPECT_EQ(threadOfALoop(), first);
}

TEST_F(LoopTest, RecoversFromADisconnectAndSaysItOnce) {
  playFrames(2);
  useControl();
  run();
  loop_->demand(true, false);
  ASSERT_TRUE(framesCome());
  command("unplug");
  ASSERT_TRUE(reaches(CaptureState::Lost));
  std::this_thread::sleep_for(std::chrono::milliseconds(500));  // several vain tries
  EXPECT_EQ(loop_->snapshot().state, CaptureState::Lost);
  ASSERT_EQ(losses().size(), 1u);
  EXPECT_NE(losses()[0].find("was disconnected"), std::string::npos) << losses()[0];
  command("replug");
  ASSERT_TRUE(framesCome());
  EXPECT_EQ(losses().size(), 1u);
  EXPECT_EQ(recoveries_, 1);
  EXPECT_EQ(loop_->snapshot().reconnects, 1u);
  EXPECT_EQ(loop_->snapshot().cause, "");
}

TEST_F(LoopTest, WatchdogNoticesAStall) {
  playFrames(2);
  useControl();
  run();
  loop_->demand(true, false);
  ASSERT_TRUE(framesCome());
  command("stall 1500");
  ASSERT_TRUE(reaches(CaptureState::Lost));
  EXPECT_NE(losses()[0].find("has stalled"), std::string::npos) << losses()[0];
  ASSERT_TRUE(framesCome());
  EXPECT_EQ(losses().size(), 1u);
  EXPECT_EQ(recoveries_, 1);
}

TEST_F(LoopTest, ADeviceWithoutColourHasNotStalled) {
  playFrames(2);
  CaptureLoop::Options options;
  options.colour = true;
  run(options);
  loop_->demand(false, true);
  EXPECT_TRUE(eventually([&] { return !loop_->snapshot().lacks.empty(); }));
  EXPECT_NE(loop_->snapshot().lacks.find("has no colour stream"), std::string::npos) << loop_->snapshot().lacks;
  std::this_thread::sleep_for(std::chrono::milliseconds(2 * params_.stall_ms));
  EXPECT_TRUE(losses().empty()) << losses()[0];
  loop_->demand(true, true);
  EXPECT_TRUE(framesCome());
  EXPECT_NE(loop_->snapshot().lacks, "");
  loop_->demand(true, false);
  EXPECT_TRUE(eventually([&] { return loop_->snapshot().lacks.empty(); }));
  EXPECT_TRUE(losses().empty());
}

TEST_F(LoopTest, FindsADeviceThatComesLater) {
  writeFrames(folder.path(), 2);
  set("VOXID_REPLAY_CONTROL", folder / "control");
  play(folder.path());
  const auto session = Device::open({""});  // keeps OpenNI2, and so the unplugged folder, alive
  ASSERT_TRUE(session.ok());
  command("unplug");
  ASSERT_TRUE(eventually([] { return listDevices().value.empty(); }));
  run();
  loop_->demand(true, false);
  ASSERT_TRUE(reaches(CaptureState::Lost));
  EXPECT_NE(losses()[0].find("no device"), std::string::npos);
  command("replug");
  EXPECT_TRUE(framesCome());
  EXPECT_EQ(losses().size(), 1u);
}

TEST_F(LoopTest, CountsFramesThatItThrowsAway) {
  playFrames(2);
  useControl();
  run();
  loop_->demand(true, false);
  ASSERT_TRUE(framesCome());
  command("corrupt 3");
  EXPECT_TRUE(eventually([&] { return loop_->snapshot().bad_frames == 3; }));
  EXPECT_TRUE(framesCome());
}

TEST_F(LoopTest, EndsWithARecordingThatIsNotToBeRepeated) {
  playFrames(3);
  set("VOXID_REPLAY_LOOP", "0");
  run();
  loop_->demand(true, false);
  ASSERT_TRUE(reaches(CaptureState::Ended));
  EXPECT_EQ(frames_, 3);
  loop_->demand(false, false);
  ASSERT_TRUE(reaches(CaptureState::Idle));
  loop_->demand(true, false);
  ASSERT_TRUE(eventually([&] { return frames_ == 6; }));
  EXPECT_TRUE(losses().empty());
}

TEST_F(LoopTest, GivesUpWhereTryingAgainIsNoUse) {
  run({"#none", false, false});
  loop_->demand(true, false);
  ASSERT_TRUE(reaches(CaptureState::Failed));
  EXPECT_EQ(losses().size(), 1u);
}

TEST_F(LoopTest, AShorterWaitHoldsForTheOneUnderWay) {
  params_.retry_first_ms = params_.retry_most_ms = 60000;
  playFrames(2);
  useControl();
  run();
  loop_->demand(true, false);
  ASSERT_TRUE(eventually([&] { return frames_ > 1; }));
  command("unplug 100");
  ASSERT_TRUE(reaches(CaptureState::Lost));
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  EXPECT_EQ(loop_->snapshot().state, CaptureState::Lost);
  params_.retry_first_ms = params_.retry_most_ms = 50;
  loop_->setParams(params_);
  EXPECT_TRUE(reaches(CaptureState::Running));
}

TEST_F(LoopTest, StopsAtOnceWhileItWaitsForADevice) {
  params_.retry_first_ms = 60000;
  run();
  loop_->demand(true, false);
  ASSERT_TRUE(reaches(CaptureState::Lost));
  const auto begin = std::chrono::steady_clock::now();
  loop_.reset();
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(5));
}

}  // namespace
}  // namespace voxid
