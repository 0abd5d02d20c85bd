// SPDX-License-Identifier: BSD-3-Clause
#include "file_beside.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

namespace voxid {

FileBeside::FileBeside(std::string path) : path_(std::move(path)) {
  struct stat there {};
  if (::stat(path_.c_str(), &there) == 0 && !S_ISREG(there.st_mode)) {
    error_ = S_ISDIR(there.st_mode) ? EISDIR : EEXIST;  // a device, which a rename would do away with
    return;
  }
  constexpr int kTries = 100;
  int file = -1;
  for (int i = 0; i < kTries && file < 0; ++i) {
    name_ = path_ + ".new-" + std::to_string(::getpid()) + "-" + std::to_string(i);
    file = ::open(name_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (file < 0 && errno != EEXIST) break;
  }
  note(file >= 0);
  if (file >= 0) stream_ = ::fdopen(file, "wb");
}

FileBeside::~FileBeside() {
  if (stream_ == nullptr) return;
  std::fclose(stream_);
  ::unlink(name_.c_str());
}

void FileBeside::write(const void* data, std::size_t bytes) {
  if (ok() && bytes > 0) note(std::fwrite(data, 1, bytes, stream_) == bytes);
}

void FileBeside::rewind() {
  if (ok()) note(std::fseek(stream_, 0, SEEK_SET) == 0);
}

void FileBeside::replace() {
  if (ok()) note(std::fflush(stream_) == 0 && ::fsync(::fileno(stream_)) == 0);
  if (ok()) note(::rename(name_.c_str(), path_.c_str()) == 0);
  if (!ok()) return;
  std::fclose(stream_);
  stream_ = nullptr;
  syncFolder();
}

Status FileBeside::status() const { return ok() ? Status{} : cannotWriteIndex(path_, std::strerror(error_)); }

void FileBeside::note(bool success) {
  if (!success && error_ == 0) error_ = errno != 0 ? errno : EIO;
}

// Without it the new name may be lost with the power; not every file system knows how, so its refusal is no failure.
void FileBeside::syncFolder() const {
  const std::size_t slash = path_.rfind('/');
  const std::string folder = slash == std::string::npos ? "." : path_.substr(0, slash + 1);
  const int file = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (file < 0) return;
  ::fsync(file);
  ::close(file);
}

Status cannotWriteIndex(const std::string& path, const std::string& why) {
  return Status::cannotDo("cannot write the index " + path + ": " + why);
}

}  // namespace voxid
