// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "depth_patch.h"

namespace voxid {

/// What the default descriptor counts of pairs of cells, each with a third one: sixteen pairs in step, a register of
/// AVX-512. doc/descriptor.md defines the bins; test/core/pair_group_test.cpp has them a pair at a time.
class PairGroup {
 public:
  static constexpr std::size_t kPairs = 16;
  using Lanes = std::array<std::int32_t, kPairs>;
  /// For each pair the bins to be counted, numbered as in kDepthHistograms.
  using Bins = std::array<Lanes, 13>;

  /// A pair that is never set is that of the patch's first cell with itself.
  void set(std::size_t pair, const SurfaceCell& first, const SurfaceCell& second, const SurfaceCell& third);
  /// `patch` is that of the cells.
  void measure(const DepthPatch& patch, Bins& bins) const;

 private:
  struct Vectors {
    Lanes x{}, y{}, z{};
  };
  /// Samples of the line from first to second that lie in front of the surface, behind it, outside the object; sum of
  /// (line's w - surface's w) over the others and these.
  struct LineParts {
    Lanes in_front, behind, outside, sag;
  };

  void walk(const DepthPatch& patch, LineParts& line) const;
  void binLine(const LineParts& line, const Lanes& distance, Bins& bins) const;
  void binNormals(const Vectors& direction, const Lanes& distance, Bins& bins) const;
  void binArea(Lanes& area) const;

  Lanes column_{}, row_{}, w_{};           // of the first cell
  Lanes to_column_{}, to_row_{}, to_w_{};  // from first to second cell
  Vectors second_, third_;                 // from the first point to these; components below 2^14
  Vectors first_normal_, second_normal_;
};

}  // namespace voxid
