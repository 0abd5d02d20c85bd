// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <ctime>

namespace voxid {

/// Time since construction, and processor time that the constructing thread has used since; for one thread.
class Stopwatch {
 public:
  float ms() const {
    return std::chrono::duration<float, std::milli>(std::chrono::steady_clock::now() - start_).count();
  }
  double cpuMs() const { return threadMs() - cpu_start_ms_; }

 private:
  static double threadMs() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) * 1e3 + static_cast<double>(now.tv_nsec) * 1e-6;
  }

  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  double cpu_start_ms_ = threadMs();
};

}  // namespace voxid
