// SPDX-License-Identifier: BSD-3-Clause
#include "above_table.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "../core/vectorised.h"

namespace voxid {
namespace {

void scale(const std::vector<std::int32_t>& from, double factor, std::vector<std::int32_t>& to) {
  to.resize(from.size());
  for (std::size_t i = 0; i < from.size(); ++i) {
    to[i] = static_cast<std::int32_t>(std::lround(std::clamp(from[i] * factor, -5e8, 5e8)));
  }
}

/// The plane `height_m` above the table: height = distance (1 - table / value), solved for value.
void raise(const PlaneSums& table, double distance_m, double height_m, PlaneSums& raised) {
  const double left_m = distance_m - height_m;
  const double factor = distance_m / (std::abs(left_m) < 1e-6 ? 1e-6 : left_m);
  scale(table.columns, factor, raised.columns);
  scale(table.rows, factor, raised.rows);
}

constexpr int kBlock = 32;  // most blocks show bare table: one test for all of it

struct Row {
  const std::int32_t *margin, *lowest, *highest;
  std::int32_t margin_row, lowest_row, highest_row, sign;
};

/// 1 for each pixel inside the bounds.
inline void markBlock(const std::int32_t* values, const Row& row, int first, int count, std::uint8_t* states) {
  for (int u = first; u < first + count; ++u) {
    const std::int32_t value = values[u];
    states[u] = static_cast<std::uint8_t>((value > 0) & (value > row.margin[u] + row.margin_row) &
                                          (value > row.lowest[u] + row.lowest_row) &
                                          (row.sign * value <= row.highest[u] + row.highest_row));
  }
}

/// One more for each marked pixel at the depth of the one before it, if that is marked, too.
inline void linkBlock(const std::int32_t* values, DepthStep gap, int first, int count, std::uint8_t* states) {
  std::uint8_t linked[kBlock];
  for (int i = 0; i < count; ++i) {
    const int u = first + i;
    linked[i] = static_cast<std::uint8_t>(static_cast<int>((states[u - 1] > 0) & gap.within(values[u - 1], values[u])) &
                                          states[u]);
  }
  for (int i = 0; i < count; ++i) states[first + i] = static_cast<std::uint8_t>(states[first + i] + linked[i]);
}

VOXID_VECTORISED void markRow(const std::int32_t* values, const Row& bounds, int width, DepthStep gap,
                              std::uint8_t* states) {
  const Row row = bounds;
  for (int first = 0; first < width; first += kBlock) {
    const int count = std::min(kBlock, width - first);
    int any = 0;
    for (int u = first; u < first + count; ++u) any |= values[u] > row.margin[u] + row.margin_row;
    if (!any) {
      std::memset(states + first, 0, static_cast<std::size_t>(count));
    } else if (first > 0 && count == kBlock) {  // loops of known length
      markBlock(values, row, first, kBlock, states);
      linkBlock(values, gap, first, kBlock, states);
    } else {
      markBlock(values, row, first, count, states);
      linkBlock(values, gap, std::max(first, 1), first > 0 ? count : count - 1, states);
    }
  }
}

}  // namespace

void AboveTable::reserve(int width_px, int height_px) {
  for (PlaneSums* sums : {&margin_, &lowest_, &highest_}) sums->reserve(width_px, height_px);
}

void AboveTable::set(const PlaneSums& table, double distance_m, int lowest_mm, int highest_mm, int margin_per_km) {
  margin_ = table;
  for (std::int32_t& row : margin_.rows) row += margin_per_km * kUnitsPerKm;
  raise(table, distance_m, std::min(lowest_mm * 1e-3, distance_m / 2), lowest_);
  raise(table, distance_m, highest_mm * 1e-3, highest_);
  sign_ = distance_m > highest_mm * 1e-3 ? 1 : -1;
  if (sign_ > 0) return;
  for (std::int32_t& column : highest_.columns) column = -column;
  for (std::int32_t& row : highest_.rows) row = -row;
}

void AboveTable::mark(const std::int32_t* values, int v, int width_px, DepthStep gap, std::uint8_t* states) const {
  const auto row = static_cast<std::size_t>(v);
  markRow(values,
          {margin_.columns.data(), lowest_.columns.data(), highest_.columns.data(), margin_.rows[row],
           lowest_.rows[row], highest_.rows[row], sign_},
          width_px, gap, states);
}

}  // namespace voxid
