// SPDX-License-Identifier: BSD-3-Clause
#include "bucket_spool.h"

#include <algorithm>

namespace voxid {
namespace {

constexpr std::size_t kRunEntries = 1 << 20;   // 16 MiB
constexpr std::size_t kReadEntries = 1 << 12;  // 64 KiB of each run while they are merged

}  // namespace

/// A sorted run, read from its spool a little at a time.
class BucketSpool::Run {
 public:
  Run(Spool& spool, std::uint64_t begin, std::uint64_t end) : spool_(&spool), at_(begin), end_(end) { fill(); }

  bool done() const { return next_ == read_.size(); }
  const Entry& front() const { return read_[next_]; }
  void pop() {
    if (++next_ == read_.size()) fill();
  }

 private:
  void fill() {
    next_ = 0;
    read_.resize(static_cast<std::size_t>(std::min<std::uint64_t>(kReadEntries, (end_ - at_) / sizeof(Entry))));
    auto* const to = reinterpret_cast<char*>(read_.data());
    const std::size_t bytes = read_.size() * sizeof(Entry);
    for (std::size_t got = 0; got < bytes;) {
      const std::size_t more = spool_->read(at_ + got, to + got, bytes - got);
      if (more == 0) return read_.clear();
      got += more;
    }
    at_ += bytes;
  }

  Spool* spool_;
  std::uint64_t at_, end_;
  std::vector<Entry> read_;
  std::size_t next_ = 0;
};

void BucketSpool::add(Key key, std::uint32_t view) {
  run_.push_back({key, view});
  if (run_.size() == kRunEntries) writeRun();
}

void BucketSpool::writeRun() {
  std::sort(run_.begin(), run_.end());
  run_starts_.push_back(runs_.bytes());
  runs_.append(run_.data(), run_.size() * sizeof(Entry));
  run_.clear();
}

void BucketSpool::finish() {
  writeRun();
  std::vector<Run> runs;
  for (std::size_t i = 0; i < run_starts_.size(); ++i) {
    runs.emplace_back(runs_, run_starts_[i], i + 1 < run_starts_.size() ? run_starts_[i + 1] : runs_.bytes());
  }
  runs.erase(std::remove_if(runs.begin(), runs.end(), [](const Run& run) { return run.done(); }), runs.end());
  const auto later = [](const Run& a, const Run& b) { return b.front() < a.front(); };
  std::make_heap(runs.begin(), runs.end(), later);
  while (!runs.empty()) {
    std::pop_heap(runs.begin(), runs.end(), later);
    put(runs.back().front());
    runs.back().pop();
    if (runs.back().done())
      runs.pop_back();
    else
      std::push_heap(runs.begin(), runs.end(), later);
  }
  offsets_.append(static_cast<std::uint32_t>(views_.bytes() / sizeof(std::uint32_t)));
  run_ = {};
}

void BucketSpool::put(const Entry& entry) {
  if (keys_.bytes() == 0 || entry.key != last_key_) {
    keys_.append(entry.key);
    offsets_.append(static_cast<std::uint32_t>(views_.bytes() / sizeof(std::uint32_t)));
    last_key_ = entry.key;
  }
  views_.append(static_cast<std::uint32_t>(entry.view));
}

int BucketSpool::error() const {
  for (const Spool* const spool : {&runs_, &keys_, &offsets_, &views_}) {
    if (spool->error() != 0) return spool->error();
  }
  return 0;
}

}  // namespace voxid
