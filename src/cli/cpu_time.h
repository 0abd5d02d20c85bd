// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ctime>

namespace voxid::cli {

/// Microseconds of CPU time that the calling thread has used: what else the machine does changes them less than a
/// clock.
inline double threadUs() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) * 1e6 + static_cast<double>(now.tv_nsec) * 1e-3;
}

/// What `work` takes of it.
template <typename Work>
double usOf(Work&& work) {
  const double start = threadUs();
  work();
  return threadUs() - start;
}

}  // namespace voxid::cli
