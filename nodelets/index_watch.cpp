// SPDX-License-Identifier: BSD-3-Clause
#include "index_watch.h"

#include <cstdint>

namespace voxid {
namespace {

// Files up to this size are not mapped: who copies over one in use, instead of renaming, would end the chain.
constexpr std::uint64_t kOwnBytes = 256 << 20;
constexpr auto kLookEvery = std::chrono::milliseconds(500);

}  // namespace

void IndexWatch::start(const std::string& path, bool watch) {
  path_ = path;
  watch_ = watch;
  if (path.empty()) {
    trouble_ = "no index is given, so labels stay empty: set ~index to a file that 'voxid build' wrote";
    return;
  }
  next_look_ = std::chrono::steady_clock::now() + kLookEvery;
  reopen(stampOf(path_));
}

bool IndexWatch::refresh() {
  const auto now = std::chrono::steady_clock::now();
  if (path_.empty() || now < next_look_ || (index_ && !watch_)) return false;
  next_look_ = now + kLookEvery;
  const Stamp stamp = stampOf(path_);
  return !equal(stamp, opened_) && reopen(stamp);
}

bool IndexWatch::equal(const Stamp& a, const Stamp& b) {
  return a.device == b.device && a.inode == b.inode && a.bytes == b.bytes && a.modified.tv_sec == b.modified.tv_sec &&
         a.modified.tv_nsec == b.modified.tv_nsec;
}

IndexWatch::Stamp IndexWatch::stampOf(const std::string& path) {
  struct stat s {};
  if (stat(path.c_str(), &s) != 0) return {};
  return {s.st_dev, s.st_ino, s.st_size, s.st_mtim};
}

bool IndexWatch::reopen(const Stamp& stamp) {
  opened_ = stamp;
  Result<std::shared_ptr<const Index>> opened = Index::open(path_, kOwnBytes);
  trouble_ = opened.status.sentence;
  if (!opened.ok()) return false;
  index_ = std::move(opened.value);
  return true;
}

}  // namespace voxid
