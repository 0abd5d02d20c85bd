// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <boost/make_shared.hpp>
#include <boost/shared_ptr.hpp>
#include <cstddef>
#include <utility>
#include <vector>

namespace voxid {

/// Messages whose memory is used again once no listener holds them, so that a chain in steady state asks for none.
template <typename Message>
class MessagePool {
 public:
  /// A message that nobody else holds, with what it held before. While listeners keep more than kMost of them, the
  /// further ones are new and not kept. One caller at a time.
  boost::shared_ptr<Message> take() {
    for (const auto& message : messages_) {
      if (message.use_count() > 1) continue;
      std::atomic_thread_fence(std::memory_order_acquire);  // what its last reader did lies before
      return message;
    }
    const auto message = boost::make_shared<Message>();
    if (messages_.size() < kMost) messages_.push_back(message);
    return message;
  }

 private:
  static constexpr std::size_t kMost = 16;
  std::vector<boost::shared_ptr<Message>> messages_;
};

/// Resizes lists inside messages without giving up the memory of what goes: strings and lists wait for a frame with
/// more. Holds no more than all lists together held at most.
template <typename Element>
class Spares {
 public:
  /// What the list holds more than before has values of some frame before.
  void resize(std::size_t size, std::vector<Element>* list) {
    while (list->size() > size) {
      spare_.push_back(std::move(list->back()));
      list->pop_back();
    }
    while (list->size() < size && !spare_.empty()) {
      list->push_back(std::move(spare_.back()));
      spare_.pop_back();
    }
    list->resize(size);
  }

 private:
  std::vector<Element> spare_;
};

}  // namespace voxid
