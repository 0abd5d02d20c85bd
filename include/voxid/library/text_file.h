// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstring>
#include <fstream>
#include <string>

namespace voxid {

/// A text file, opened for reading behind the byte order mark with which some editors begin UTF-8: to a comparison of
/// names it would be part of the first one.
inline std::ifstream openText(const std::string& path) {
  constexpr char kMark[] = "\xEF\xBB\xBF";
  std::ifstream file(path);
  if (file.peek() != 0xEF) return file;
  char first[sizeof kMark - 1] = {};
  if (!file.read(first, sizeof first) || std::memcmp(first, kMark, sizeof first) != 0) {
    file.clear();
    file.seekg(0);
  }
  return file;
}

}  // namespace voxid
