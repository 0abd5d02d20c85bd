// SPDX-License-Identifier: BSD-3-Clause
#include "recogniser_pool.h"

#include <algorithm>
#include <numeric>

#include "stopwatch.h"

namespace voxid {

RecogniserPool::RecogniserPool(const std::shared_ptr<const Index>& index,
                               const std::shared_ptr<const AnswerScope>& scope, int threads) {
  for (int i = 0; i < std::max(1, threads); ++i) recognisers_.push_back(std::make_unique<Recogniser>(index, scope));
  for (std::size_t i = 1; i < recognisers_.size(); ++i) helpers_.emplace_back([this, i] { help(*recognisers_[i]); });
}

RecogniserPool::~RecogniserPool() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stop_ = true;
  }
  work_.notify_all();
  for (std::thread& helper : helpers_) helper.join();
}

const std::vector<Answer>& RecogniserPool::recogniseAll(const DepthView& depth, Span<const ObjectPixels> objects,
                                                        const ClassifyParams& params,
                                                        const std::function<void(std::size_t)>& also) {
  std::unique_lock<std::mutex> lock(mutex_);
  depth_ = depth;
  objects_ = objects;
  params_ = params;
  also_ = &also;
  answers_.assign(objects.size, Answer{});
  orderBySize();
  next_ = answered_ = 0;
  count_ = objects.size;
  if (count_ > 1) work_.notify_all();
  while (next_ < count_) {
    const std::size_t object = order_[next_++];
    lock.unlock();
    answer(*recognisers_.front(), object);
    lock.lock();
    ++answered_;
  }
  // Only what a helper has begun is waited for, never a helper that has not woken yet.
  finished_.wait(lock, [this] { return answered_ == count_; });
  return answers_;
}

/// Large objects take longest: a thread that began one last would be waited for by all others.
void RecogniserPool::orderBySize() {
  order_.resize(objects_.size);
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  std::sort(order_.begin(), order_.end(), [this](std::size_t a, std::size_t b) {
    return objects_[a].size != objects_[b].size ? objects_[a].size > objects_[b].size : a < b;
  });
}

double RecogniserPool::helpersCpuMs() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return helpers_cpu_ms_;
}

void RecogniserPool::help(Recogniser& recogniser) {
  const Stopwatch watch;
  double told_ms = 0;
  std::unique_lock<std::mutex> lock(mutex_);
  for (;;) {
    work_.wait(lock, [this] { return stop_ || next_ < count_; });
    if (stop_) return;
    const std::size_t object = order_[next_++];
    lock.unlock();
    answer(recogniser, object);
    const double used_ms = watch.cpuMs();
    lock.lock();
    helpers_cpu_ms_ += used_ms - told_ms;
    told_ms = used_ms;
    if (++answered_ == count_) finished_.notify_one();
  }
}

void RecogniserPool::answer(Recogniser& recogniser, std::size_t object) {
  (*also_)(object);
  answers_[object] = recogniser.recognise(depth_, objects_[object], params_);
}

}  // namespace voxid
