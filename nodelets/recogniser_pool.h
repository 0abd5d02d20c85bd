// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <condition_variable>
#include <cstddef>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "recogniser.h"

namespace voxid {

/// The pixels (row * width + column) of one object.
using ObjectPixels = Span<const std::uint32_t>;

/// Several recognisers of one index share the objects of a frame. Which of them takes an object changes nothing in its
/// answer, and answers come in the order of the objects. The largest are taken first.
class RecogniserPool {
 public:
  /// The caller's thread is one of the `threads`.
  RecogniserPool(const std::shared_ptr<const Index>& index, const std::shared_ptr<const AnswerScope>& scope,
                 int threads);
  ~RecogniserPool();

  /// Valid until the next call. One caller at a time. also(i): what else the thread that takes the i-th object does for
  /// it.
  const std::vector<Answer>& recogniseAll(
      const DepthView& depth, Span<const ObjectPixels> objects, const ClassifyParams& params,
      const std::function<void(std::size_t)>& also = [](std::size_t) {});

  int threads() const { return static_cast<int>(recognisers_.size()); }
  const Index& index() const { return recognisers_.front()->index(); }
  double helpersCpuMs() const;  ///< processor time of the other threads since construction

 private:
  void orderBySize();
  void help(Recogniser& recogniser);
  void answer(Recogniser& recogniser, std::size_t object);

  std::vector<std::unique_ptr<Recogniser>> recognisers_;
  std::vector<Answer> answers_;
  std::vector<std::size_t> order_;  // in which the objects are taken
  DepthView depth_;
  Span<const ObjectPixels> objects_;
  ClassifyParams params_;
  const std::function<void(std::size_t)>* also_ = nullptr;

  mutable std::mutex mutex_;
  std::condition_variable work_, finished_;
  std::size_t next_ = 0, answered_ = 0, count_ = 0;  // of order_
  double helpers_cpu_ms_ = 0;
  bool stop_ = false;
  std::vector<std::thread> helpers_;
};

}  // namespace voxid
