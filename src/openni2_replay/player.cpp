// SPDX-License-Identifier: BSD-3-Clause
#include "player.h"

#include <algorithm>

namespace voxid::replay {

void Faults::stall(int ms) {
  std::lock_guard<std::mutex> lock(mutex_);
  stalled_until_ = Clock::now() + std::chrono::milliseconds(ms);
}

void Faults::drop(int frames) {
  std::lock_guard<std::mutex> lock(mutex_);
  drop_ += frames;
}

void Faults::corrupt(int frames) {
  std::lock_guard<std::mutex> lock(mutex_);
  corrupt_ += frames;
}

void Faults::noise(int frames) {
  std::lock_guard<std::mutex> lock(mutex_);
  noise_ += frames;
}

void Faults::setUnplugged(bool unplugged) {
  std::lock_guard<std::mutex> lock(mutex_);
  unplugged_ = unplugged;
}

bool Faults::unplugged() const {
  std::lock_guard<std::mutex> lock(mutex_);
  return unplugged_;
}

Faults::Effect Faults::next() {
  std::lock_guard<std::mutex> lock(mutex_);
  if (unplugged_ || Clock::now() < stalled_until_) return Effect::Hold;
  if (drop_ > 0) return --drop_, Effect::Skip;
  if (corrupt_ > 0) return --corrupt_, Effect::Corrupt;
  if (noise_ > 0) return --noise_, Effect::Noise;
  return Effect::None;
}

Player::Player(const Config& config, int images, Faults& faults, std::function<void()> on_end)
    : config_(config), images_(images), faults_(faults), on_end_(std::move(on_end)) {}

Player::~Player() {
  {
    std::lock_guard<std::mutex> lock(mutex_);
    stop_ = true;
  }
  wake_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void Player::add(Viewer* viewer) {
  std::lock_guard<std::mutex> lock(mutex_);
  viewers_.push_back(viewer);
  if (thread_.joinable()) return;
  stop_ = false;
  thread_ = std::thread(&Player::run, this);
}

void Player::remove(Viewer* viewer) {
  std::thread finished;
  {
    std::lock_guard<std::mutex> lock(mutex_);
    viewers_.erase(std::remove(viewers_.begin(), viewers_.end(), viewer), viewers_.end());
    if (!viewers_.empty()) return;
    stop_ = true;
    finished.swap(thread_);
  }
  wake_.notify_all();
  if (finished.joinable()) finished.join();
}

bool Player::sleepUntil(Faults::Clock::time_point due) {
  std::unique_lock<std::mutex> lock(mutex_);
  return !wake_.wait_until(lock, due, [this] { return stop_; });
}

void Player::showAll(const Shot& shot) {
  std::lock_guard<std::mutex> lock(mutex_);
  for (Viewer* viewer : viewers_) viewer->show(shot);
}

void Player::run() {
  const std::chrono::nanoseconds period(1000000000LL / config_.fps);
  const std::int64_t shots_a_round = static_cast<std::int64_t>(images_) * config_.hold;
  std::int64_t shown = 0;
  auto due = Faults::Clock::now();
  for (std::int64_t tick = 0; sleepUntil(due); ++tick) {
    if (!config_.loop && shown == shots_a_round) return on_end_();
    const Faults::Effect effect = faults_.next();
    due = std::max(due + period, Faults::Clock::now());  // a late consumer slows the device down; no burst afterwards
    if (effect == Faults::Effect::Hold) continue;
    const int image = static_cast<int>(shown++ % shots_a_round / config_.hold);
    const auto timestamp_us = static_cast<std::uint64_t>(tick * 1000000 / config_.fps);
    if (effect != Faults::Effect::Skip) showAll({image, static_cast<int>(shown), timestamp_us, effect});
  }
}

}  // namespace voxid::replay
