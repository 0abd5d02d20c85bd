// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

namespace voxid {

/// A borrowed run of values: pointer and length, nothing owned (C++17 has no std::span).
template <typename T>
struct Span {
  T* data = nullptr;
  std::size_t size = 0;

  T* begin() const { return data; }
  T* end() const { return data + size; }
  T& operator[](std::size_t i) const { return data[i]; }
  bool empty() const { return size == 0; }
};

}  // namespace voxid
