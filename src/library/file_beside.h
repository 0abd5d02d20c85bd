// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdio>
#include <string>

#include "voxid/core/status.h"

namespace voxid {

/// A file beside the one to be replaced. Removed unless it came to `replace`.
class FileBeside {
 public:
  explicit FileBeside(std::string path);
  ~FileBeside();
  FileBeside(const FileBeside&) = delete;
  FileBeside& operator=(const FileBeside&) = delete;

  void write(const void* data, std::size_t bytes);
  void rewind();
  void replace();

  bool ok() const { return error_ == 0; }
  /// The first thing that went wrong.
  Status status() const;

 private:
  void note(bool success);
  void syncFolder() const;

  std::string path_, name_;
  std::FILE* stream_ = nullptr;
  int error_ = 0;
};

/// "cannot write the index PATH: WHY".
Status cannotWriteIndex(const std::string& path, const std::string& why);

}  // namespace voxid
