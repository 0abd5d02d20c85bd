// SPDX-License-Identifier: BSD-3-Clause
// Sums of neighbouring bins of the paper's descriptor: 52 bytes that bound its L1 distance from below.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "voxid/core/index.h"
#include "voxid/core/search.h"
#include "voxid/core/span.h"

namespace voxid {

/// Section SUMS of an index of profile "paper": a sketch a view, in the order of the views. Byte i is the sum of bins
/// 8 i to 8 i + 7 (the groups of the paper's key) in steps of 3, rounded down, at most 255. Eight bins of a descriptor
/// sum to 725 at most (doc/index_format.md), so that none is cut off; what is cut off all the same costs no exactness.
constexpr std::size_t kSketchBytes = 52;
constexpr std::uint32_t kSketchStep = 3;
constexpr std::uint32_t kSketchedViews = 1024;  ///< a smaller index has none: all its codes are compared as quickly
constexpr std::uint16_t kMinorSketch = 4;       ///< format version of files with SUMS, at least

/// `sketch`: kSketchBytes.
void sketchOf(const std::uint8_t* bins416, std::uint8_t* sketch);

/// The sketch bytes that cost a query nothing, from `low` to `high`. Behind the 52 all do, so that rows are read in
/// whole vectors.
struct SketchQuery {
  static constexpr std::size_t kBytes = 64;
  std::array<std::uint8_t, kBytes> low, high;
};
SketchQuery sketchQueryOf(const std::uint8_t* bins416);

/// Of `count` views, what their L1 distance to the query is at least: kSketchStep times how far the sketches' bytes lie
/// outside the query's intervals, 0 to 39,780. `sketches`: count x kSketchBytes. Proof in doc/index_format.md.
void lowerBounds(const SketchQuery& query, const std::uint8_t* sketches, std::size_t count, std::uint16_t* bounds);

/// Section SUMS; empty where the index has none of the right length.
Span<const std::uint8_t> sketchesOf(const Index& index);

/// The nearest views exactly as makeExactSearch finds them, for an index that has sketches: codes are compared in full
/// only where the sketch does not rule them out. Of the categories the nearest ones are given, exactly as there: those
/// that the nearest kCategoryPool views belong to, or as many more as it takes to have ten (or all). All memory is
/// taken here.
std::unique_ptr<Search> makeSketchSearch(std::shared_ptr<const Index> index);

}  // namespace voxid
