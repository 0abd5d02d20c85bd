// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

#include "file_beside.h"
#include "spool.h"
#include "voxid/core/crc32c.h"
#include "voxid/core/index_format.h"

namespace voxid {

/// Sections one after another, each at a multiple of 64 bytes, its sum taken on the way: nothing is held in memory.
class SectionWriter {
 public:
  /// `tags` in the order in which the sections are written.
  SectionWriter(FileBeside& file, std::vector<const char*> tags)
      : file_(file), tags_(std::move(tags)), table_(tags_.size()) {
    const std::vector<std::uint8_t> blank(sizeof(format::Header) + tableBytes());
    file_.write(blank.data(), blank.size());
    position_ = blank.size();
  }

  void section(const void* data, std::size_t bytes) {
    begin();
    put(data, bytes);
    ++count_;
  }
  template <typename T>
  void section(const std::vector<T>& entries) {
    section(entries.data(), entries.size() * sizeof(T));
  }
  void section(Spool& spool) {
    begin();
    spool.forEachPiece([this](const void* data, std::size_t bytes) { put(data, bytes); });
    ++count_;
  }

  /// Header and table go in last, when lengths and sums are known.
  void finish(format::Header header) {
    pad();
    header.file_bytes = position_;
    header.sections = static_cast<std::uint32_t>(tags_.size());
    header.crc32c = crc32c(table_.data(), tableBytes(), crc32c(&header, sizeof header));
    file_.rewind();
    file_.write(&header, sizeof header);
    file_.write(table_.data(), tableBytes());
  }

 private:
  std::size_t tableBytes() const { return table_.size() * sizeof(format::Section); }

  void begin() {
    pad();
    format::Section& section = table_[count_];
    std::memcpy(section.tag, tags_[count_], sizeof section.tag);
    section.offset = position_;
  }
  void put(const void* data, std::size_t bytes) {
    format::Section& section = table_[count_];
    section.crc32c = crc32c(data, bytes, section.crc32c);
    section.length += bytes;
    file_.write(data, bytes);
    position_ += bytes;
  }
  void pad() {
    constexpr std::uint8_t kZeros[format::kAlignment] = {};
    const std::size_t bytes = (format::kAlignment - position_ % format::kAlignment) % format::kAlignment;
    file_.write(kZeros, bytes);
    position_ += bytes;
  }

  FileBeside& file_;
  std::vector<const char*> tags_;
  std::vector<format::Section> table_;
  std::size_t count_ = 0;
  std::uint64_t position_ = 0;
};

}  // namespace voxid
