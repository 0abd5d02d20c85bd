// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>

namespace voxid {

/// A thread that is kept when its work is done, and given the next work: there are as many as ever worked at once.
/// OpenNI2 remembers each thread that has called it, and asks later, by pthread_kill, whether it still lives. Of a
/// thread that has ended, that reads memory which is gone: a process that starts and ends a capture now and then
/// crashes.
class LastingThread {
 public:
  /// Starts the work.
  explicit LastingThread(std::function<void()> work);
  /// Waits for its end.
  ~LastingThread();
  LastingThread(const LastingThread&) = delete;
  LastingThread& operator=(const LastingThread&) = delete;

 private:
  class Worker;
  Worker* worker_;
};

}  // namespace voxid
