// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <functional>
#include <utility>
#include <vector>

#include "file_beside.h"
#include "spool.h"
#include "voxid/core/crc32c.h"
#include "voxid/core/index_format.h"
#include "voxid/core/span.h"

namespace voxid {

/// The sections of a file, said one after another, then written each at a multiple of 64 bytes, its sum taken on the
/// way: nothing but the table is held in memory. What `add` is given is read when `write` is called.
class SectionWriter {
 public:
  void add(const char* tag, Spool& spool) {
    add(tag, [this, &spool] { spool.forEachPiece([this](const void* data, std::size_t bytes) { put(data, bytes); }); });
  }
  template <typename T>
  void add(const char* tag, Span<const T> entries) {
    add(tag, [this, entries] { put(entries.data, entries.size * sizeof(T)); });
  }
  template <typename T>
  void add(const char* tag, const std::vector<T>& entries) {
    add(tag, Span<const T>{entries.data(), entries.size()});
  }

  void write(FileBeside& file, format::Header header) {
    file_ = &file;
    table_.resize(contents_.size());
    const std::vector<std::uint8_t> blank(sizeof header + tableBytes());
    file.write(blank.data(), blank.size());
    position_ = blank.size();
    for (current_ = 0; current_ < contents_.size(); ++current_) writeSection();
    pad();
    finish(header);
  }

 private:
  std::size_t tableBytes() const { return table_.size() * sizeof(format::Section); }

  void add(const char* tag, std::function<void()> write) { contents_.push_back({tag, std::move(write)}); }

  void writeSection() {
    pad();
    std::memcpy(table_[current_].tag, contents_[current_].tag, sizeof table_[current_].tag);
    table_[current_].offset = position_;
    contents_[current_].write();
  }
  // Header and table go in last, when lengths and sums are known.
  void finish(format::Header header) {
    header.file_bytes = position_;
    header.sections = static_cast<std::uint32_t>(table_.size());
    header.crc32c = crc32c(table_.data(), tableBytes(), crc32c(&header, sizeof header));
    file_->rewind();
    file_->write(&header, sizeof header);
    file_->write(table_.data(), tableBytes());
  }
  void put(const void* data, std::size_t bytes) {
    format::Section& section = table_[current_];
    section.crc32c = crc32c(data, bytes, section.crc32c);
    section.length += bytes;
    file_->write(data, bytes);
    position_ += bytes;
  }
  void pad() {
    constexpr std::uint8_t kZeros[format::kAlignment] = {};
    const std::size_t bytes = (format::kAlignment - position_ % format::kAlignment) % format::kAlignment;
    file_->write(kZeros, bytes);
    position_ += bytes;
  }

  struct Content {
    const char* tag;
    std::function<void()> write;
  };
  std::vector<Content> contents_;
  std::vector<format::Section> table_;
  FileBeside* file_ = nullptr;
  std::size_t current_ = 0;
  std::uint64_t position_ = 0;
};

}  // namespace voxid
