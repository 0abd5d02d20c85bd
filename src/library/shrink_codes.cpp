// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/library/shrink_codes.h"

#include <array>

#include "voxid/core/projection.h"

namespace voxid {
namespace {

constexpr std::int64_t kOwn = 3, kMean = 1;  // parts of a code that stay, and that come from the mean

std::int8_t number(const std::uint8_t* code, std::size_t i) { return static_cast<std::int8_t>(code[i]); }

}  // namespace

void shrinkToMean(const std::vector<std::uint8_t*>& codes, std::size_t code_bytes) {
  const auto views = static_cast<std::int64_t>(codes.size());
  std::array<std::int64_t, Projection::kMostCodeBytes> sum{}, moved{};
  for (const std::uint8_t* const code : codes) {
    for (std::size_t i = 0; i < code_bytes; ++i) sum[i] += number(code, i);
  }
  for (std::uint8_t* const code : codes) {
    for (std::size_t i = 0; i < code_bytes; ++i) moved[i] = kOwn * views * number(code, i) + kMean * sum[i];
    bringToLength(moved.data(), code_bytes, code);
  }
}

// Moved codes sum to kOwn + kMean times what the own ones do.
void takeBackFromMean(const std::uint8_t* codes, std::size_t views, std::size_t code_bytes, std::uint8_t* code) {
  std::array<std::int64_t, Projection::kMostCodeBytes> back{};
  for (std::size_t i = 0; i < code_bytes; ++i) {
    std::int64_t sum = 0;
    for (std::size_t view = 0; view < views; ++view) sum += number(codes + view * code_bytes, i);
    back[i] = (kOwn + kMean) * static_cast<std::int64_t>(views) * number(code, i) - kMean * sum;
  }
  bringToLength(back.data(), code_bytes, code);
}

}  // namespace voxid
