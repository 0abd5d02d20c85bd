// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "spool.h"
#include "voxid/core/key.h"

namespace voxid {

/// Sorts views into buckets by key, whatever their number: runs are sorted in memory, wait on disk and are merged.
class BucketSpool {
 public:
  explicit BucketSpool(const std::string& beside) : runs_(beside), keys_(beside), offsets_(beside), views_(beside) {}

  /// Views in ascending order.
  void add(Key key, std::uint32_t view);
  /// After the last; then the sections are there.
  void finish();

  Spool& keys() { return keys_; }        ///< KEYS
  Spool& offsets() { return offsets_; }  ///< BKTO
  Spool& views() { return views_; }      ///< BKTV
  std::uint32_t buckets() const { return static_cast<std::uint32_t>(keys_.bytes() / sizeof(Key)); }
  int error() const;

 private:
  struct Entry {
    Key key;
    std::uint64_t view;
  };
  friend bool operator<(const Entry& a, const Entry& b) { return a.key != b.key ? a.key < b.key : a.view < b.view; }
  class Run;

  void writeRun();
  void put(const Entry& entry);

  std::vector<Entry> run_;
  std::vector<std::uint64_t> run_starts_;
  Spool runs_, keys_, offsets_, views_;
  Key last_key_ = 0;
};

}  // namespace voxid
