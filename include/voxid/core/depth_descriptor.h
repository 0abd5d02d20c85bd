// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "voxid/core/depth_view.h"
#include "voxid/core/descriptor.h"
#include "voxid/core/span.h"

namespace voxid {

/// The sub-histograms of the depth descriptor, in the order of its bytes. "Distance" is that of the two points of a
/// pair, in shares of D; "line" the straight line between them, walked in the depth image; angles are those of surface
/// normals. doc/descriptor.md defines each and says what it is worth.
constexpr std::array<SubHistogram, 16> kDepthHistograms{{
    {"distance", 0, 64},                      // D2 of the paper
    {"line parts x distance", 64, 256},       // how much of it is in front, behind, outside
    {"line kind x distance", 320, 128},       // what most of it is: on, in front, behind, outside
    {"line part, each x distance", 448, 96},  // front, behind, outside alone, in finer steps
    {"sag x distance", 544, 128},             // mean depth of the surface under the line
    {"normals' angle x distance", 672, 128},
    {"normals and line x distance", 800, 288},  // both normals' angles with the line
    {"convexity x normals' angle x distance", 1088, 128},
    {"line's slope x distance", 1216, 64},  // its angle with the viewing axis
    {"angle of three", 1280, 64},           // A3 and D3 of Osada et al.
    {"area of three", 1344, 64},
    {"radius", 1408, 32},  // distance from the centroid
    {"radius x normal's slope", 1440, 64},
    {"radius x normal along the radius", 1504, 64},
    {"normal's slope", 1568, 32},
    {"normal's slope x depth", 1600, 64},
}};
constexpr int kDepthHistogramBins = 1664;

/// The sub-histograms and, behind them, 468 numbers of the layout about the centroid: products of the Fourier series of
/// rings, which no roll of the camera changes.
constexpr int kDepthBins = kDepthHistogramBins + 468;

/// A bin of a histogram holds 255 sqrt(share of its sub-histogram), rounded to nearest; a number of the layout
/// 128 + 254 sign(p) sqrt(|p|), p a product, the object's whole surface one.
using DepthBins = std::array<std::uint8_t, kDepthBins>;

/// Raised by a change of any byte of any depth descriptor.
constexpr std::uint32_t kDepthDescriptorRevision = 2;

/// Sub-histograms of an object's visible surface as the camera sees it: the raw form of the default descriptor, which a
/// Projection makes small. Beyond the paper: its line is walked in the depth image, where what lies beside it is known
/// to be empty, hidden or not part of the object (the inside and outside of its reference [12], for a single view), and
/// the surface has normals. Needs pixels, hence a camera; a cloud without order has only the paper's.
///
/// All memory (about 2 MiB) is taken at construction; `describe` allocates nothing and keeps no state. Integers only.
/// One object a thread.
class DepthDescriber {
 public:
  /// `pairs` of cells are drawn by a generator with `seed`; 1 to kMaxPairs, clamped.
  explicit DepthDescriber(const DescriptorParams& params);
  ~DepthDescriber();
  DepthDescriber(DepthDescriber&&) noexcept;
  DepthDescriber& operator=(DepthDescriber&&) noexcept;

  /// Of the object that `pixels` (row * width + column) show; above 65,536 every n-th is taken, evenly. Empty without
  /// depth or a valid camera, Degenerate (and zero) if all of it falls into one cell of D / 64.
  DescribeStatus describe(const DepthView& depth, Span<const std::uint32_t> pixels, DepthBins& bins);

 private:
  struct Workspace;
  std::unique_ptr<Workspace> workspace_;
};

}  // namespace voxid
