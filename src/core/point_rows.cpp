// SPDX-License-Identifier: BSD-3-Clause
#include "point_rows.h"

#include "vectorised.h"

namespace voxid {

// By values, not by std::min()'s references: so GCC vectorises it.
VOXID_VECTORISED Range rangeOf(const std::int32_t* row, std::size_t size) {
  std::int32_t least = row[0], most = row[0];
  for (std::size_t i = 0; i < size; ++i) {
    least = row[i] < least ? row[i] : least;
    most = row[i] > most ? row[i] : most;
  }
  return {least, most};
}

VOXID_VECTORISED void shiftRow(std::int32_t* row, std::size_t size, std::int32_t corner, int left, int right) {
  for (std::size_t i = 0; i < size; ++i) {
    const std::uint32_t from_corner = static_cast<std::uint32_t>(row[i]) - static_cast<std::uint32_t>(corner);
    row[i] = static_cast<std::int32_t>(from_corner << left >> right);
  }
}

VOXID_VECTORISED Moments momentsOf(const std::int32_t* row, std::size_t size) {
  std::uint64_t sum = 0, squares = 0;
  for (std::size_t i = 0; i < size; ++i) {
    const std::uint64_t p = static_cast<std::uint32_t>(row[i]);
    sum += p;
    squares += p * p;
  }
  return {static_cast<std::int64_t>(sum), static_cast<std::int64_t>(squares)};
}

}  // namespace voxid
