// SPDX-License-Identifier: BSD-3-Clause
#include "worker_pool.h"

#include <signal.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <new>
#include <vector>

namespace voxid {
namespace {

constexpr int kPending = -1, kReported = -2, kNoItem = -1;

/// What the processes share: plain numbers in an anonymous shared mapping.
class Board {
 public:
  Board(int items, int jobs)
      : items_(items), bytes_(sizeof(Head) + sizeof(std::atomic<int>) * static_cast<std::size_t>(items + jobs)) {
    void* const memory = ::mmap(nullptr, bytes_, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED) throw std::bad_alloc();
    head_ = new (memory) Head;
    auto* const numbers = reinterpret_cast<std::atomic<int>*>(static_cast<char*>(memory) + sizeof(Head));
    results_ = numbers;
    current_ = numbers + items;
    for (int i = 0; i < items; ++i) new (&results_[i]) std::atomic<int>(kPending);
    for (int i = 0; i < jobs; ++i) new (&current_[i]) std::atomic<int>(kNoItem);
  }
  ~Board() { ::munmap(head_, bytes_); }
  Board(const Board&) = delete;
  Board& operator=(const Board&) = delete;

  /// The next item nobody has taken, kNoItem if all are.
  int take(int worker) {
    const int item = head_->next.fetch_add(1);
    current_[worker] = item < items_ ? item : kNoItem;
    return current_[worker];
  }
  bool exhausted() const { return head_->next.load() >= items_; }
  void finish(int worker, int item, int result) {
    results_[item] = result;
    current_[worker] = kNoItem;
  }
  std::atomic<int>& result(int item) { return results_[item]; }
  int current(int worker) const { return current_[worker]; }

  void refuse(const Status& status) {
    int none = 0;
    if (!head_->refused.compare_exchange_strong(none, 1)) return;
    head_->kind = static_cast<int>(status.kind);
    std::snprintf(head_->sentence, sizeof head_->sentence, "%s", status.sentence.c_str());
    head_->refused = 2;
  }
  Status refusal() const {
    if (head_->refused != 2) return {};
    return {static_cast<Status::Kind>(head_->kind), head_->sentence};
  }

 private:
  struct Head {
    std::atomic<int> next{0}, refused{0};
    int kind = 0;
    char sentence[1000] = {};
  };
  int items_;
  std::size_t bytes_;
  Head* head_ = nullptr;
  std::atomic<int>*results_ = nullptr, *current_ = nullptr;
};

[[noreturn]] void runWorker(const PoolWork& work, Board& board, int worker, pid_t parent) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(1);
  for (int item = board.take(worker); item != kNoItem; item = board.take(worker)) {
    Result<int> result = Status::cannotDo("");
    try {
      result = work.work(item);
    } catch (...) {
      ::abort();  // out of memory, most likely; reported as a death at this item
    }
    if (!result.ok()) {
      board.refuse(result.status);
      ::_exit(0);
    }
    board.finish(worker, item, result.value);
  }
  ::_exit(0);
}

class Pool {
 public:
  Pool(int jobs, const PoolWork& work)
      : work_(work), board_(work.items, jobs), pids_(static_cast<std::size_t>(jobs), 0) {}
  ~Pool() { stop(); }
  Pool(const Pool&) = delete;
  Pool& operator=(const Pool&) = delete;

  Status run() {
    Status status;
    for (std::size_t i = 0; i < pids_.size() && status.ok(); ++i) status = start(i);
    while (status.ok() && running()) {
      ::usleep(50000);
      status = reap();
      report();
      work_.onTick();
      if (status.ok()) status = board_.refusal();
    }
    return status.ok() ? board_.refusal() : status;
  }

 private:
  Status start(std::size_t worker) {
    const pid_t parent = ::getpid();
    const pid_t child = ::fork();
    if (child == 0) runWorker(work_, board_, static_cast<int>(worker), parent);
    if (child < 0) return Status::cannotDo(std::string("no worker process: ") + std::strerror(errno));
    pids_[worker] = child;
    return {};
  }

  bool running() const {
    return std::any_of(pids_.begin(), pids_.end(), [](pid_t pid) { return pid != 0; });
  }

  Status reap() {
    Status status;
    for (std::size_t i = 0; i < pids_.size() && status.ok(); ++i) {
      int ending = 0;
      if (pids_[i] == 0 || ::waitpid(pids_[i], &ending, WNOHANG) != pids_[i]) continue;
      pids_[i] = 0;
      const bool well = WIFEXITED(ending) && WEXITSTATUS(ending) == 0;
      if (!well) status = replace(i, ending);
    }
    return status;
  }

  Status replace(std::size_t worker, int ending) {
    const std::string how =
        WIFSIGNALED(ending) ? ::strsignal(WTERMSIG(ending)) : "exit code " + std::to_string(WEXITSTATUS(ending));
    const int item = board_.current(static_cast<int>(worker));
    if (item == kNoItem && ++idle_deaths_ > 100) return Status::cannotDo("workers keep dying (" + how + ")");
    if (item != kNoItem && board_.result(item) == kPending) {
      board_.result(item) = kReported;
      work_.onDied(item, how);
    }
    return board_.exhausted() ? Status{} : start(worker);
  }

  void report() {
    for (int i = 0; i < work_.items; ++i) {
      const int result = board_.result(i);
      if (result < 0) continue;
      board_.result(i) = kReported;
      work_.onDone(i, result);
    }
  }

  void stop() {
    for (const pid_t pid : pids_) {
      if (pid == 0) continue;
      ::kill(pid, SIGKILL);
      while (::waitpid(pid, nullptr, 0) < 0 && errno == EINTR) {
      }
    }
  }

  const PoolWork& work_;
  Board board_;
  std::vector<pid_t> pids_;
  int idle_deaths_ = 0;
};

}  // namespace

Status runInProcesses(int jobs, const PoolWork& work) {
  return Pool(std::max(1, std::min(jobs, work.items)), work).run();
}

}  // namespace voxid
