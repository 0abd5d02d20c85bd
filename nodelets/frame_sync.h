// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <message_filters/pass_through.h>
#include <message_filters/subscriber.h>
#include <message_filters/sync_policies/exact_time.h>
#include <message_filters/synchronizer.h>

#include <boost/bind/bind.hpp>
#include <functional>
#include <memory>
#include <tuple>

namespace voxid {

/// Brings together what has the same stamp. Where too many stamps wait for their other half, message_filters drops the
/// oldest: after a clock went backwards (a bag that begins again, a simulator) those that wait would keep every new
/// frame out. So what waits is forgotten once frames are dropped again and again and none becomes complete. Callbacks
/// of one thread at a time.
template <typename... Messages>
class FrameSync {
 public:
  /// `method` of `object` gets the complete frames, `dropped` is called for each that will not become complete.
  template <typename T, typename Method>
  FrameSync(int queue, message_filters::Subscriber<Messages>&... subscribers, T* object, Method method,
            std::function<void()> dropped)
      : most_in_a_row_(2 * queue) {
    renew_ = [this, queue, object, method, dropped] {
      dropped_in_a_row_ = 0;
      sync_ = std::apply([&](auto&... passes) { return std::make_unique<Sync>(Policy(queue), passes...); }, passes_);
      sync_->registerCallback(method, object);
      sync_->registerCallback(boost::bind(&FrameSync::onComplete, this));
      sync_->registerDropCallback(boost::bind(&FrameSync::onDrop, this, dropped));
    };
    renew_();
    std::apply([&](auto&... passes) { (listen(subscribers, passes), ...); }, passes_);
  }

 private:
  using Policy = message_filters::sync_policies::ExactTime<Messages...>;
  using Sync = message_filters::Synchronizer<Policy>;

  void onComplete() { dropped_in_a_row_ = 0; }
  void onDrop(const std::function<void()>& dropped) {
    ++dropped_in_a_row_;
    dropped();
  }

  template <typename M>
  void listen(message_filters::Subscriber<M>& subscriber, message_filters::PassThrough<M>& pass) {
    using Pointer = boost::shared_ptr<const M>;
    subscriber.registerCallback(boost::function<void(const Pointer&)>([this, &pass](const Pointer& message) {
      if (dropped_in_a_row_ >= most_in_a_row_) renew_();
      pass.add(message);
    }));
  }

  const int most_in_a_row_;
  int dropped_in_a_row_ = 0;
  std::tuple<message_filters::PassThrough<Messages>...> passes_;
  std::unique_ptr<Sync> sync_;
  std::function<void()> renew_;
};

}  // namespace voxid
