// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "voxid/core/depth_view.h"
#include "voxid/core/span.h"

namespace voxid {

/// The six sub-histograms of the paper's descriptor (Sec. IV.A), in the order of the 416 bytes.
struct SubHistogram {
  const char* name;
  std::uint16_t first_bin, bins;
};
constexpr std::array<SubHistogram, 6> kSubHistograms{{
    {"D2 coarse", 0, 32},
    {"D2 fine", 32, 128},
    {"ON", 160, 64},
    {"OFF", 224, 64},
    {"MIXED", 288, 64},
    {"ratio", 352, 64},
}};
constexpr int kDescriptorBytes = 416;
/// Raised by a change of any byte of any descriptor: an index of another revision is refused.
constexpr std::uint32_t kDescriptorRevision = 2;

/// The paper's descriptor: 416 bins. A bin holds 255 sqrt(share of all pairs), rounded to nearest; the ratio histogram
/// holds half of that (its weight in the paper). Compared by L1.
using Descriptor = std::array<std::uint8_t, kDescriptorBytes>;

/// What the paper leaves open; each choice with its figure in doc/descriptor.md. The values go into every index, and an
/// index made with others is refused.
struct DescriptorParams {
  std::uint32_t pairs = 10000;  ///< lines drawn, 1 to kMaxPairs (clamped): below 4,000 histogram noise costs accuracy,
                                ///< above 10,000 nothing is gained; time grows in proportion
  std::uint32_t seed = 1;       ///< of the own generator; nothing else is random
};

constexpr std::uint32_t kMaxPairs = 1000000;

enum class DescribeStatus : std::uint8_t {
  Ok,
  Empty,       ///< no points
  Degenerate,  ///< one point, or all points equal: there is no distance to put into a histogram; all bins are zero
};
const char* nameOf(DescribeStatus status);

struct Described {
  DescribeStatus status = DescribeStatus::Empty;
  Descriptor bins{};
};

/// Makes descriptors. All memory (about 1.4 MiB) is taken at construction; `describe` allocates nothing, has no state
/// that lasts from one call to the next, and does at most `pairs` x 64 grid reads after three passes over the points.
/// One object a thread.
class Describer {
 public:
  explicit Describer(const DescriptorParams& params = {});
  ~Describer();
  Describer(Describer&&) noexcept;
  Describer& operator=(Describer&&) noexcept;

  /// The paper's descriptor of a point set, Sec. IV.A: a function of the points (in their order), organised or not.
  /// Invariant to translation exactly, to a doubled scale exactly and to others up to rounding. Any int32 coordinates.
  /// Above 65,536 points every n-th is taken, evenly.
  Described describe(Span<const PointUm> points);

  /// The same for the pixels (row * width + column) of a depth image; pixels without depth or outside the image are
  /// left out. Empty without a valid camera.
  Described describe(const DepthView& depth, Span<const std::uint32_t> pixels);

  const DescriptorParams& params() const;

 private:
  struct Workspace;
  std::unique_ptr<Workspace> workspace_;
};

/// Sum of absolute differences (the paper's distance, Sec. IV.A); 0 to 416 x 255 = 106,080.
std::uint32_t l1(const std::uint8_t* a, const std::uint8_t* b);

}  // namespace voxid
