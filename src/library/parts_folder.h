// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
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
  ~PartsFolder() { letGo(); }

  Status open(const std::string& out, bool keep) {
    Status status = make(out);
    if (status.ok()) status = lock(out);
    if (!status.ok()) return status;
    removeAll([keep](const std::string& name) { return keep ? isUnfinished(name) : name != kLock; }, path_);
    const std::filesystem::path file(out);
    const std::string beside = file.filename().string() + ".new-";  // as FileBeside names them
    const auto isHalf = [&](const std::string& name) {
      return name.compare(0, beside.size(), beside) == 0 &&
             name.find_first_not_of("0123456789-", beside.size()) == std::string::npos;
    };
    removeAll(isHalf, file.parent_path());
    return {};
  }

  /// Beside others, who keep each other out or divide the work.
  Status join(const std::string& out) { return make(out); }

  /// With all that is in it. The lock goes last: until then others stay away.
  void remove() {
    removeAll([](const std::string& name) { return name != kLock; }, path_);
    std::error_code ignored;
    std::filesystem::remove(lockFile(), ignored);
    std::filesystem::remove(path_, ignored);
  }

  /// Whether models of an interrupted build wait in it.
  bool hasModels() const {
    std::error_code ignored;
    for (const auto& entry : std::filesystem::directory_iterator(path_, ignored))
      if (entry.path().extension() == ".shard") return true;
    return false;
  }

  const std::string& path() const { return path_; }

 private:
  static constexpr char kLock[] = "lock";
  std::string lockFile() const { return path_ + "/" + kLock; }

  /// `out` will be replaced by rename, which would do away with a device, too.
  Status make(const std::string& out) {
    std::error_code error;
    if (std::filesystem::is_directory(out, error))
      return Status::cannotDo(out + " is a folder; expected a file's name");
    if (std::filesystem::exists(out, error) && !std::filesystem::is_regular_file(out, error))
      return Status::cannotDo(out + " is no regular file; choose another name");
    path_ = out + ".parts";
    std::filesystem::create_directory(path_, error);
    return error ? Status::cannotDo("cannot make " + path_ + ": " + error.message()) : Status{};
  }

  Status lock(const std::string& out) {
    const auto running = [&] {
      return Status::cannotDo("another build of " + out + " is running; wait for it, or choose another name");
    };
    lock_ = ::open(lockFile().c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (lock_ < 0 && errno == ENOENT) return running();  // it has just ended, and took the folder with it
    if (lock_ < 0) return Status::cannotDo("cannot write in " + path_ + ": " + std::strerror(errno));
    if (::flock(lock_, LOCK_EX | LOCK_NB) == 0 && isThere(lock_)) return {};
    letGo();
    return running();
  }

  /// Not if who held the lock removed its file between our opening and our locking: others would lock a new one.
  bool isThere(int file) const {
    struct stat held {};
    struct stat named {};
    return ::fstat(file, &held) == 0 && ::stat(lockFile().c_str(), &named) == 0 && held.st_ino == named.st_ino &&
           held.st_dev == named.st_dev;
  }

  void letGo() {
    if (lock_ >= 0) ::close(lock_);
    lock_ = -1;
  }

  /// What add, remove, merge and the end of a build leave there if they are killed.
  static bool isUnfinished(const std::string& name) {
    return name.compare(0, 9, "draft.vxi") == 0 || name.compare(0, 9, "added.vxi") == 0;
  }

  template <typename Unwanted>
  static void removeAll(Unwanted unwanted, const std::filesystem::path& folder) {
    std::error_code ignored;
    for (const auto& entry : std::filesystem::directory_iterator(folder.empty() ? "." : folder, ignored)) {
      if (unwanted(entry.path().filename().string())) std::filesystem::remove_all(entry.path(), ignored);
    }
  }

  std::string path_;
  int lock_ = -1;
};

}  // namespace voxid
