// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>

namespace voxid {

/// Time since construction.
class Stopwatch {
 public:
  float ms() const {
    return std::chrono::duration<float, std::milli>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace voxid
