// SPDX-License-Identifier: BSD-3-Clause
#include "spool.h"

#include <fcntl.h>
#include <stdlib.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace voxid {

Spool::~Spool() {
  if (file_ >= 0) ::close(file_);
}

void Spool::append(const void* data, std::size_t bytes) {
  const auto* const from = static_cast<const char*>(data);
  for (std::size_t done = 0; done < bytes && error_ == 0;) {
    const std::size_t piece = std::min(bytes - done, kHeld - held_.size());
    held_.append(from + done, piece);
    done += piece;
    if (held_.size() == kHeld) writeOut();
  }
}

void Spool::makeFile() {
  std::string name = beside_ + ".spool-XXXXXX";
  file_ = ::mkostemp(name.data(), O_CLOEXEC);
  if (file_ < 0)
    error_ = errno;
  else
    ::unlink(name.c_str());
}

void Spool::writeOut() {
  if (file_ < 0) makeFile();
  for (std::size_t done = 0; done < held_.size() && error_ == 0;) {
    const ssize_t wrote =
        ::pwrite(file_, held_.data() + done, held_.size() - done, static_cast<off_t>(on_disk_ + done));
    if (wrote > 0)
      done += static_cast<std::size_t>(wrote);
    else if (errno != EINTR)
      error_ = errno != 0 ? errno : EIO;
  }
  on_disk_ += held_.size();
  held_.clear();
}

std::size_t Spool::read(std::uint64_t at, void* to, std::size_t most) {
  if (at >= on_disk_) {
    const std::size_t from = static_cast<std::size_t>(at - on_disk_);
    const std::size_t size = std::min(most, held_.size() - std::min(from, held_.size()));
    if (size > 0) std::memcpy(to, held_.data() + from, size);
    return size;
  }
  const std::size_t size = static_cast<std::size_t>(std::min<std::uint64_t>(most, on_disk_ - at));
  ssize_t got = 0;
  do got = ::pread(file_, to, size, static_cast<off_t>(at));
  while (got < 0 && errno == EINTR);
  if (got <= 0) error_ = got < 0 ? errno : EIO;
  return got > 0 ? static_cast<std::size_t>(got) : 0;
}

}  // namespace voxid
