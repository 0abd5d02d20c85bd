// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace voxid {

/// Bytes that wait on disk until they are wanted: the last MiB is held in memory, what is before it in a file without a
/// name, which goes with the process however that ends.
class Spool {
 public:
  /// `beside`: a path in whose folder there is room.
  explicit Spool(std::string beside) : beside_(std::move(beside)) {}
  ~Spool();
  Spool(const Spool&) = delete;
  Spool& operator=(const Spool&) = delete;

  void append(const void* data, std::size_t bytes);
  template <typename T>
  void append(const T& value) {
    append(&value, sizeof value);
  }
  std::uint64_t bytes() const { return on_disk_ + held_.size(); }

  /// Copies what begins at `at`, at most `most` bytes; how many there were.
  std::size_t read(std::uint64_t at, void* to, std::size_t most);

  /// take(data, size) for all of it, piece by piece.
  template <typename Take>
  void forEachPiece(Take take) {
    std::vector<std::uint8_t> piece(kHeld);
    for (std::uint64_t at = 0; at < bytes() && error_ == 0;) {
      const std::size_t size = read(at, piece.data(), piece.size());
      take(piece.data(), size);
      at += size;
    }
  }

  /// errno of the first thing that went wrong, after which nothing more is kept; 0 = nothing.
  int error() const { return error_; }

 private:
  static constexpr std::size_t kHeld = 1 << 20;
  void makeFile();
  void writeOut();

  std::string beside_;
  std::string held_;
  std::uint64_t on_disk_ = 0;
  int file_ = -1, error_ = 0;
};

}  // namespace voxid
