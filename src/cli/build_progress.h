// SPDX-License-Identifier: BSD-3-Clause
// What commands that render a library say to people.
#pragma once

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <string>
#include <thread>
#include <vector>

#include "command.h"
#include "voxid/library/builder.h"

namespace voxid::cli {

/// One line on a terminal, redrawn in place; nothing elsewhere.
class ProgressBar : public BuildListener {
 public:
  ~ProgressBar() override {
    if (drawn_) std::fprintf(stderr, "\r\033[K");
  }
  void onSkipped(const SkippedModel&) override { ++skipped_; }
  void onProgress(int done, int models, std::uint64_t views) override {
    if (!terminal_) return;
    drawn_ = true;
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    const int left_s = done > 0 ? static_cast<int>(seconds * (models - done) / done) : 0;
    const int filled = models > 0 ? kWidth * done / models : 0;
    const std::string bar = std::string(static_cast<std::size_t>(filled), '#') +
                            std::string(static_cast<std::size_t>(kWidth - filled), '.');
    std::fprintf(stderr, "\r\033[K[%s] %d/%d models, %.0f views/s, %d:%02d left, %d skipped", bar.c_str(), done, models,
                 static_cast<double>(views) / std::max(seconds, 0.001), left_s / 60, left_s % 60, skipped_);
  }

 private:
  static constexpr int kWidth = 30;
  bool terminal_ = ::isatty(STDERR_FILENO) == 1, drawn_ = false;
  int skipped_ = 0;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

inline void printSkipped(const std::vector<SkippedModel>& models) {
  for (const SkippedModel& skipped : models) {
    std::fprintf(stderr, "voxid: skipped %s: %s\n", oneLine(skipped.model).c_str(), oneLine(skipped.reason).c_str());
  }
}

inline int processors() { return std::max(1, static_cast<int>(std::thread::hardware_concurrency())); }

}  // namespace voxid::cli
