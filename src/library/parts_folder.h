// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string>

#include "voxid/core/status.h"

namespace voxid {

/// <out>.parts, where finished models wait; one process at a time works on `out`.
class PartsFolder {
 public:
  ~PartsFolder() {
    if (lock_ >= 0) ::close(lock_);
  }

  Status open(const std::string& out, bool keep) {
    path_ = out + ".parts";
    std::error_code error;
    std::filesystem::create_directory(path_, error);
    if (error) return Status::cannotDo("cannot make " + path_ + ": " + error.message());
    lock_ = ::open((path_ + "/lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (lock_ < 0) return Status::cannotDo("cannot write in " + path_ + ": " + std::strerror(errno));
    if (::flock(lock_, LOCK_EX | LOCK_NB) != 0)
      return Status::cannotDo("another build of " + out + " is running; wait for it, or choose another name");
    if (!keep) clear();
    return {};
  }

  /// Beside others, who keep each other out or divide the work.
  Status join(const std::string& out) {
    path_ = out + ".parts";
    std::error_code error;
    std::filesystem::create_directory(path_, error);
    return error ? Status::cannotDo("cannot make " + path_ + ": " + error.message()) : Status{};
  }

  void remove() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  const std::string& path() const { return path_; }

 private:
  void clear() {
    std::error_code ignored;
    for (const auto& entry : std::filesystem::directory_iterator(path_, ignored)) {
      if (entry.path().filename() != "lock") std::filesystem::remove(entry.path(), ignored);
    }
  }

  std::string path_;
  int lock_ = -1;
};

}  // namespace voxid
