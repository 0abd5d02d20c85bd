// SPDX-License-Identifier: BSD-3-Clause
#include "lasting_thread.h"

#include <condition_variable>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace voxid {

/// Lives as long as the process.
class LastingThread::Worker {
 public:
  static Worker* take() {
    const std::lock_guard<std::mutex> lock(idle().mutex);
    if (idle().workers.empty()) return new Worker;
    Worker* const worker = idle().workers.back();
    idle().workers.pop_back();
    return worker;
  }
  static void giveBack(Worker* worker) {
    const std::lock_guard<std::mutex> lock(idle().mutex);
    idle().workers.push_back(worker);
  }

  void start(std::function<void()> work) {
    const std::lock_guard<std::mutex> lock(mutex_);
    work_ = std::move(work);
    changed_.notify_all();
  }
  void awaitEnd() {
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait(lock, [this] { return !work_; });
  }

 private:
  struct Idle {
    std::mutex mutex;
    std::vector<Worker*> workers;
  };
  static Idle& idle() {
    static Idle& all = *new Idle;  // its threads still wait when statics are destroyed
    return all;
  }

  Worker() { std::thread(&Worker::run, this).detach(); }

  void run() {
    std::unique_lock<std::mutex> lock(mutex_);
    for (;;) {
      changed_.wait(lock, [this] { return static_cast<bool>(work_); });
      lock.unlock();
      work_();
      lock.lock();
      work_ = nullptr;
      changed_.notify_all();
    }
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::function<void()> work_;
};

LastingThread::LastingThread(std::function<void()> work) : worker_(Worker::take()) { worker_->start(std::move(work)); }

LastingThread::~LastingThread() {
  worker_->awaitEnd();
  Worker::giveBack(worker_);
}

}  // namespace voxid
