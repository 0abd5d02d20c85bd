// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/core/sketch.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>

#include "vectorised.h"

namespace voxid {
namespace {

constexpr std::size_t kBinsPerSum = kDescriptorBytes / kSketchBytes;
constexpr std::uint32_t kMostByte = 255;

std::uint32_t sumAt(const std::uint8_t* bins, std::size_t group) {
  std::uint32_t sum = 0;
  for (std::size_t i = 0; i < kBinsPerSum; ++i) sum += bins[group * kBinsPerSum + i];
  return sum;
}

// In this form compilers find the instruction for sums of absolute differences (psadbw).
inline __attribute__((always_inline)) std::uint32_t outside(const std::uint8_t* low, const std::uint8_t* high,
                                                            const std::uint8_t* sketch) {
  int sum = 0;
  for (std::size_t i = 0; i < SketchQuery::kBytes; ++i) {
    const std::uint8_t raised = sketch[i] > low[i] ? sketch[i] : low[i];
    const std::uint8_t inside = raised < high[i] ? raised : high[i];
    sum += std::abs(sketch[i] - inside);
  }
  return static_cast<std::uint32_t>(sum);
}

// Reads SketchQuery::kBytes of each row, the last ones of the next row.
VOXID_VECTORISED void boundsOfRows(const std::uint8_t* low, const std::uint8_t* high, const std::uint8_t* sketches,
                                   std::size_t count, std::uint16_t* bounds) {
  for (std::size_t i = 0; i < count; ++i)
    bounds[i] = static_cast<std::uint16_t>(kSketchStep * outside(low, high, sketches + i * kSketchBytes));
}

}  // namespace

void sketchOf(const std::uint8_t* bins416, std::uint8_t* sketch) {
  for (std::size_t i = 0; i < kSketchBytes; ++i)
    sketch[i] = static_cast<std::uint8_t>(std::min(sumAt(bins416, i) / kSketchStep, kMostByte));
}

// A view's byte b stands for a sum of at least 3 b, and of at most 3 b + 2 unless b is 255. The query's own sum A is
// known: bytes above ceil(A / 3) are farther by at least 3 each, and so are those below floor((A - 2) / 3).
SketchQuery sketchQueryOf(const std::uint8_t* bins416) {
  constexpr std::uint32_t kMostSum = kMostByte * kSketchStep + kSketchStep - 1;
  SketchQuery query;
  query.low.fill(0);
  query.high.fill(kMostByte);
  for (std::size_t i = 0; i < kSketchBytes; ++i) {
    const std::uint32_t sum = std::min(sumAt(bins416, i), kMostSum), slack = kSketchStep - 1;
    query.low[i] = static_cast<std::uint8_t>((std::max(sum, slack) - slack) / kSketchStep);
    query.high[i] = static_cast<std::uint8_t>(std::min((sum + slack) / kSketchStep, kMostByte));
  }
  return query;
}

void lowerBounds(const SketchQuery& query, const std::uint8_t* sketches, std::size_t count, std::uint16_t* bounds) {
  if (count == 0) return;
  boundsOfRows(query.low.data(), query.high.data(), sketches, count - 1, bounds);
  std::array<std::uint8_t, SketchQuery::kBytes> last{};
  std::memcpy(last.data(), sketches + (count - 1) * kSketchBytes, kSketchBytes);
  boundsOfRows(query.low.data(), query.high.data(), last.data(), 1, bounds + count - 1);
}

Span<const std::uint8_t> sketchesOf(const Index& index) {
  for (const format::Section& section : index.sections()) {
    if (std::memcmp(section.tag, "SUMS", sizeof section.tag) != 0) continue;
    if (index.projection() || section.length != std::uint64_t{index.viewCount()} * kSketchBytes) return {};
    return {index.file().data + section.offset, static_cast<std::size_t>(section.length)};
  }
  return {};
}

}  // namespace voxid
