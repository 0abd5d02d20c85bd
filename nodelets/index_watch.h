// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/stat.h>

#include <chrono>
#include <memory>
#include <string>

#include "voxid/core/index.h"

namespace voxid {

/// Keeps an index file open and notices when it appears or is replaced. A replacement that cannot be opened leaves the
/// index that was there in use, and `trouble` says why.
class IndexWatch {
 public:
  /// `watch` false: the file is opened once and never looked at again (a missing one is still waited for).
  void start(const std::string& path, bool watch);

  /// Looks at the file, at most twice a second. True if `index()` is another one than before.
  bool refresh();

  const std::shared_ptr<const Index>& index() const { return index_; }
  const std::string& trouble() const { return trouble_; }  ///< empty if the newest file is in use

 private:
  struct Stamp {
    dev_t device = 0;
    ino_t inode = 0;
    off_t bytes = 0;
    timespec modified{};
  };
  static bool equal(const Stamp& a, const Stamp& b);
  static Stamp stampOf(const std::string& path);
  bool reopen(const Stamp& stamp);

  std::string path_, trouble_;
  bool watch_ = true;
  Stamp opened_;
  std::chrono::steady_clock::time_point next_look_;
  std::shared_ptr<const Index> index_;
};

}  // namespace voxid
