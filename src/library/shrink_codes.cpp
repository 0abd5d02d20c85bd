// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/library/shrink_codes.h"

#include <array>

#include "voxid/core/code.h"

namespace voxid {
namespace {

constexpr std::int64_t kOwn = 3, kMean = 1;  // parts of a code that stay, and that come from the mean

using Numbers = std::array<std::int64_t, kCodeNumbers>;

void add(const CodeNumbers& numbers, Numbers& sum) {
  for (std::size_t i = 0; i < kCodeNumbers; ++i) sum[i] += numbers[i];
}

}  // namespace

void shrinkToMean(const std::vector<std::uint8_t*>& codes, std::size_t code_bytes) {
  const auto views = static_cast<std::int64_t>(codes.size());
  Numbers sum{}, moved;
  for (const std::uint8_t* const code : codes) add(numbersOf(code, code_bytes), sum);
  for (std::uint8_t* const code : codes) {
    const CodeNumbers own = numbersOf(code, code_bytes);
    for (std::size_t i = 0; i < kCodeNumbers; ++i) moved[i] = kOwn * views * own[i] + kMean * sum[i];
    bringToLength(moved.data(), code_bytes, code);
  }
}

// Moved codes sum to kOwn + kMean times what the own ones do.
void takeBackFromMean(const std::uint8_t* codes, std::size_t views, std::size_t code_bytes, std::uint8_t* code) {
  Numbers sum{}, back;
  for (std::size_t view = 0; view < views; ++view) add(numbersOf(codes + view * code_bytes, code_bytes), sum);
  const CodeNumbers own = numbersOf(code, code_bytes);
  for (std::size_t i = 0; i < kCodeNumbers; ++i)
    back[i] = (kOwn + kMean) * static_cast<std::int64_t>(views) * own[i] - kMean * sum[i];
  bringToLength(back.data(), code_bytes, code);
}

}  // namespace voxid
